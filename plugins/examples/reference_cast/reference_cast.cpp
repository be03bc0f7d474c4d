// cast/reference: emission and absorption on the CPU in double precision, by the definitions alone: trilinear
// values between voxel centres, the transfer table's lookup, the exponential midpoint rule on the lattice
// t_i = (i + 1/2) step. Slow and plain on purpose: it is the oracle that fast raycasters are compared with.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "brace_stage.h"

namespace {

struct Vec {
  double x = 0, y = 0, z = 0;
};

class Reference {
 public:
  Reference(double step_units, double termination_opacity)
      : step_units_(step_units), termination_opacity_(termination_opacity) {}

  brace_result activate(const brace_activation& with) {
    if (with.volume == nullptr || with.transfer == nullptr) return fail(BRACE_UNSUPPORTED, "needs a volume");
    const brace_volume& volume = *with.volume;
    std::copy(volume.dims, volume.dims + 3, dims_);
    metres_per_unit_ = volume.metres_per_unit;
    for (int axis = 0; axis < 3; ++axis)
      spacing_[axis] = volume.spacing[axis];
    const double* first = with.transfer->entries_rgbk;
    entries_.assign(first, first + 4 * std::size_t{with.transfer->entry_count});
    minimum_ = with.transfer->minimum;
    maximum_ = with.transfer->maximum;
    return read_voxels(volume);
  }

  void deactivate() {
    voxels_ = {};
    entries_ = {};
  }

  brace_result execute(const brace_cast_frame& frame) const {
    if (frame.params.mapped == nullptr || frame.ray_entries.mapped == nullptr) return BRACE_INVALID_ARGUMENT;
    float params[40];  // BraceEyeParams; the eye stands first
    std::memcpy(params, frame.params.mapped, sizeof params);
    const Vec eye{params[0], params[1], params[2]};
    std::uint64_t samples = 0;
    for (std::uint32_t y = frame.area.y; y < frame.area.y + frame.area.height; ++y) {
      for (std::uint32_t x = frame.area.x; x < frame.area.x + frame.area.width; ++x) {
        cast_ray(frame, eye, std::size_t{y} * frame.rays_across + x, samples);
      }
    }
    if (frame.counted != nullptr) {
      frame.counted->rays += std::uint64_t{frame.area.width} * frame.area.height;
      frame.counted->samples += samples;
    }
    return BRACE_OK;
  }

  const char* last_error() const { return error_.c_str(); }

  brace_result fail(brace_result result, const char* why) {
    error_ = why;
    return result;
  }

 private:
  brace_result read_voxels(const brace_volume& volume) {
    const std::size_t slice = std::size_t{dims_[0]} * dims_[1];
    const std::size_t bytes_per_voxel = volume.type == BRACE_VOXEL_UINT8     ? 1
                                        : volume.type == BRACE_VOXEL_FLOAT32 ? 4
                                                                             : 2;
    voxels_.resize(slice * dims_[2]);
    std::vector<unsigned char> raw(slice * bytes_per_voxel);
    for (std::uint32_t z = 0; z < dims_[2]; ++z) {
      const brace_result read = volume.read_slices(&volume, z, 1, raw.data(), raw.size());
      if (read != BRACE_OK) return fail(read, "the volume's voxels could not be read");
      for (std::size_t i = 0; i < slice; ++i) {
        voxels_[z * slice + i] =
            static_cast<float>(voxel(raw.data(), i, volume.type) * volume.value_scale + volume.value_offset);
      }
    }
    return BRACE_OK;
  }

  static double voxel(const unsigned char* raw, std::size_t i, brace_voxel_type type) {
    const auto load = [&](auto value) {
      std::memcpy(&value, raw + i * sizeof value, sizeof value);
      return static_cast<double>(value);
    };
    switch (type) {
      case BRACE_VOXEL_UINT8:
        return load(std::uint8_t{});
      case BRACE_VOXEL_INT16:
        return load(std::int16_t{});
      case BRACE_VOXEL_UINT16:
        return load(std::uint16_t{});
      case BRACE_VOXEL_FLOAT32:
        return load(float{});
    }
    return 0.0;
  }

  // The two voxels along an axis between which a point lies, and its place between them.
  struct Between {
    std::size_t low, high;
    double place;
  };
  static Between between(double at, std::uint32_t size) {
    const double centred = std::clamp(at - 0.5, 0.0, static_cast<double>(size - 1));
    const auto low = static_cast<std::size_t>(centred);
    return {low, std::min<std::size_t>(low + 1, size - 1), centred - static_cast<double>(low)};
  }

  double value(const Vec& at) const {
    const Between x = between(at.x, dims_[0]), y = between(at.y, dims_[1]), z = between(at.z, dims_[2]);
    const auto row = [&](std::size_t j, std::size_t k) {
      const std::size_t start = (k * dims_[1] + j) * dims_[0];
      return (1.0 - x.place) * voxels_[start + x.low] + x.place * voxels_[start + x.high];
    };
    const auto slice = [&](std::size_t k) {
      return (1.0 - y.place) * row(y.low, k) + y.place * row(y.high, k);
    };
    return (1.0 - z.place) * slice(z.low) + z.place * slice(z.high);
  }

  // r, g, b, kappa.
  void look_up(double at, double rgbk[4]) const {
    const double last = static_cast<double>(entries_.size() / 4 - 1);
    const double u = std::clamp((at - minimum_) / (maximum_ - minimum_), 0.0, 1.0) * last;
    const double i = std::min(std::floor(u), last - 1.0);
    const double* low = &entries_[4 * static_cast<std::size_t>(i)];
    for (int c = 0; c < 4; ++c)
      rgbk[c] = (1.0 - (u - i)) * low[c] + (u - i) * low[4 + c];
  }

  void cast_ray(const brace_cast_frame& frame, const Vec& eye, std::size_t index,
                std::uint64_t& samples) const {
    float entry[4], direction[4];
    std::memcpy(entry, static_cast<const float*>(frame.ray_entries.mapped) + 4 * index, sizeof entry);
    std::memcpy(direction, static_cast<const float*>(frame.ray_directions.mapped) + 4 * index,
                sizeof direction);
    double colour[3] = {0, 0, 0};
    double optical_depth = 0.0;
    double hit = std::numeric_limits<double>::infinity();
    const double segments = entry[3] / step_units_;
    const double count = entry[3] > 0.0f ? std::ceil(segments) : 0.0;
    for (double i = 0; i < count; i += 1.0) {
      const double part = std::min(segments - i, 1.0);
      const double t = (i + 0.5 * part) * step_units_;
      double rgbk[4];
      look_up(value({entry[0] + t * direction[0], entry[1] + t * direction[1], entry[2] + t * direction[2]}),
              rgbk);
      ++samples;
      if (!(rgbk[3] > 0.0)) continue;
      hit = std::min(hit, t);
      const double before = std::exp(-optical_depth);
      optical_depth += rgbk[3] * part * step_units_;
      const double after = std::exp(-optical_depth);
      for (int c = 0; c < 3; ++c)
        colour[c] += (before - after) * rgbk[c];
      if (termination_opacity_ < 1.0 && after <= 1.0 - termination_opacity_) break;
    }
    const double opacity = -std::expm1(-optical_depth);
    float out[4];
    for (int c = 0; c < 3; ++c)
      out[c] = static_cast<float>(std::clamp(colour[c], 0.0, opacity));
    out[3] = static_cast<float>(opacity);
    for (int c = 0; c < 3; ++c)
      out[c] = std::min(out[c], out[3]);
    const double to_entry = std::hypot((entry[0] - eye.x) * spacing_[0], (entry[1] - eye.y) * spacing_[1],
                                       (entry[2] - eye.z) * spacing_[2]);
    const auto depth_m = static_cast<float>((to_entry + hit) * metres_per_unit_);
    std::memcpy(static_cast<float*>(frame.result_colours.mapped) + 4 * index, out, sizeof out);
    std::memcpy(static_cast<float*>(frame.result_depths_m.mapped) + index, &depth_m, sizeof depth_m);
  }

  double step_units_, termination_opacity_;
  std::uint32_t dims_[3] = {1, 1, 1};
  double spacing_[3] = {1, 1, 1};
  double metres_per_unit_ = 1.0;
  double minimum_ = 0.0, maximum_ = 1.0;
  std::vector<float> voxels_;
  std::vector<double> entries_;
  std::string error_;
};

// No exception leaves a function of the interface.
template <typename Call>
brace_result guarded(Reference& self, Call&& call) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return self.fail(BRACE_ERROR, "out of memory");
  } catch (...) {
    return self.fail(BRACE_ERROR, "an unexpected exception");
  }
}

extern "C" {

static void* create(const double* values, uint32_t count) {
  return count == 2 ? new (std::nothrow) Reference(values[0], values[1]) : nullptr;
}
static void destroy(void* self) {
  delete static_cast<Reference*>(self);
}
static brace_result activate(void* self, const brace_activation* activation) {
  auto& stage = *static_cast<Reference*>(self);
  return guarded(stage, [&] { return stage.activate(*activation); });
}
static void deactivate(void* self) {
  static_cast<Reference*>(self)->deactivate();
}
static brace_result execute(void* self, const brace_cast_frame* frame) {
  return static_cast<const Reference*>(self)->execute(*frame);
}
static const char* last_error(void* self) {
  return static_cast<const Reference*>(self)->last_error();
}

}  // extern "C"

const brace_param params[] = {
    {sizeof(brace_param), "step_voxels", BRACE_PARAM_FLOAT, "voxels",
     "Distance between samples in the smallest voxel spacing", 0.001, 64.0, 0.5, nullptr},
    {sizeof(brace_param), "termination_opacity", BRACE_PARAM_FLOAT, "",
     "A ray ends when it is this opaque; 1 lets every ray run through", 0.01, 1.0, 0.99, nullptr},
};

const brace_cast_functions functions = {sizeof functions, nullptr, execute, 0};

const brace_stage_descriptor descriptor = {
    sizeof descriptor,
    BRACE_KIND_CAST,
    "reference",
    "1.0.0",
    "Emission and absorption in double precision on the CPU: an oracle, not a fast raycaster",
    params,
    2,
    create,
    destroy,
    &functions,
    activate,
    deactivate,
    last_error};

const brace_stage_descriptor* const stages[] = {&descriptor};

}  // namespace

extern "C" BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "reference_cast", "1.0.0", stages, 1);
}
