/* cast/@NAME@: emission and absorption on the CPU, with the nearest voxel's value. Rays come in, colours and
 * first-hit depths go out; the comments of brace_stage.h state the buffers, units and rules. */
#include <brace/brace_stage.h>
#include <brace/eye_params.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct stage {
  double step_voxels, density; /* the parameters */
  const char* error;
  /* From activate to deactivate: */
  const brace_transfer_table* transfer;
  uint32_t dims[3];
  float* voxels; /* in the data's own units, x fastest */
} stage;

enum { P_STEP, P_DENSITY, P_COUNT };

static const brace_param params[P_COUNT] = {
    {sizeof(brace_param), "step_voxels", BRACE_PARAM_FLOAT, "voxels",
     "Distance between samples in the smallest voxel spacing", 0.05, 16.0, 1.0, NULL},
    {sizeof(brace_param), "density", BRACE_PARAM_FLOAT, "", "Factor on the transfer function's absorption",
     0.0, 100.0, 1.0, NULL},
};

static void* create(const double* values, uint32_t count) {
  if (count != P_COUNT) return NULL;
  stage* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->step_voxels = values[P_STEP];
  self->density = values[P_DENSITY];
  return self;
}

static void destroy(void* self) {
  free(self);
}

static double stored_value(const unsigned char* raw, size_t i, brace_voxel_type type) {
  int16_t i16;
  uint16_t u16;
  float f32;
  switch (type) {
    case BRACE_VOXEL_UINT8:
      return raw[i];
    case BRACE_VOXEL_INT16:
      memcpy(&i16, raw + 2 * i, sizeof i16);
      return i16;
    case BRACE_VOXEL_UINT16:
      memcpy(&u16, raw + 2 * i, sizeof u16);
      return u16;
    case BRACE_VOXEL_FLOAT32:
      memcpy(&f32, raw + 4 * i, sizeof f32);
      return f32;
  }
  return 0.0;
}

static brace_result read_voxels(stage* self, const brace_volume* volume) {
  const size_t slice = (size_t)volume->dims[0] * volume->dims[1];
  const size_t voxel_bytes = volume->type == BRACE_VOXEL_UINT8     ? 1
                             : volume->type == BRACE_VOXEL_FLOAT32 ? 4
                                                                   : 2;
  unsigned char* raw = malloc(slice * voxel_bytes);
  self->voxels = malloc(slice * volume->dims[2] * sizeof(float));
  brace_result result = BRACE_OK;
  if (raw == NULL || self->voxels == NULL) {
    self->error = "out of memory";
    result = BRACE_ERROR;
  }
  for (uint32_t z = 0; result == BRACE_OK && z < volume->dims[2]; ++z) {
    result = volume->read_slices(volume, z, 1, raw, slice * voxel_bytes);
    for (size_t i = 0; result == BRACE_OK && i < slice; ++i) {
      const double value = stored_value(raw, i, volume->type) * volume->value_scale + volume->value_offset;
      self->voxels[z * slice + i] = (float)value;
    }
  }
  free(raw);
  return result;
}

static void deactivate(void* object) {
  stage* self = object;
  free(self->voxels);
  self->voxels = NULL;
}

static brace_result activate(void* object, const brace_activation* activation) {
  stage* self = object;
  self->error = NULL;
  if (activation->volume == NULL || activation->transfer == NULL) {
    self->error = "needs a volume and a transfer function";
    return BRACE_UNSUPPORTED;
  }
  self->transfer = activation->transfer;
  memcpy(self->dims, activation->volume->dims, sizeof self->dims);
  const brace_result result = read_voxels(self, activation->volume);
  if (result != BRACE_OK) deactivate(self);
  return result;
}

static size_t nearest(float at, uint32_t size) {
  return at <= 0.0f ? 0 : at >= (float)size ? size - 1 : (size_t)at;
}

static double value_at(const stage* self, const float at[3]) {
  const size_t x = nearest(at[0], self->dims[0]), y = nearest(at[1], self->dims[1]),
               z = nearest(at[2], self->dims[2]);
  return self->voxels[(z * self->dims[1] + y) * self->dims[0] + x];
}

/* r, g, b and absorption per unit of length, as brace_transfer_table defines the look-up. */
static void look_up(const brace_transfer_table* table, double value, double rgbk[4]) {
  const double last = (double)table->entry_count - 1.0;
  if (isnan(value)) { /* empty by definition */
    memset(rgbk, 0, 4 * sizeof rgbk[0]);
    return;
  }
  double u = (value - table->minimum) / (table->maximum - table->minimum);
  u = (u > 0.0 ? u < 1.0 ? u : 1.0 : 0.0) * last;
  const double i = u < last - 1.0 ? floor(u) : last - 1.0;
  const double* low = table->entries_rgbk + 4 * (size_t)i;
  for (int c = 0; c < 4; ++c)
    rgbk[c] = (1.0 - (u - i)) * low[c] + (u - i) * low[4 + c];
}

/* Returns the number of samples. `colour` gets a premultiplied colour, `hit` units from the entry or
 * infinity. */
static uint64_t cast_ray(const stage* self, const float entry[4], const float direction[4], float colour[4],
                         double* hit) {
  double sum[3] = {0.0, 0.0, 0.0}, optical_depth = 0.0;
  uint64_t samples = 0;
  *hit = INFINITY;
  for (double begin = 0.0; begin < entry[3] && optical_depth < 5.0; begin += self->step_voxels) {
    const double length = fmin(self->step_voxels, entry[3] - begin);
    const double t = begin + 0.5 * length;
    float at[3];
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = entry[axis] + (float)t * direction[axis];
    double rgbk[4];
    look_up(self->transfer, value_at(self, at), rgbk);
    ++samples;
    const double absorbed = self->density * rgbk[3] * length;
    if (!(absorbed > 0.0)) continue;
    if (t < *hit) *hit = t;
    const double before = exp(-optical_depth);
    optical_depth += absorbed;
    for (int c = 0; c < 3; ++c)
      sum[c] += (before - exp(-optical_depth)) * rgbk[c];
  }
  colour[3] = (float)(1.0 - exp(-optical_depth));
  for (int c = 0; c < 3; ++c)
    colour[c] = fminf((float)sum[c], colour[3]);
  return samples;
}

static brace_result execute(void* object, const brace_cast_frame* frame) {
  const stage* self = object;
  const struct BraceEyeParams* eye = frame->params.mapped;
  const float* entries = frame->ray_entries.mapped;
  const float* directions = frame->ray_directions.mapped;
  float* colours = frame->result_colours.mapped;
  float* depths_m = frame->result_depths_m.mapped;
  uint64_t samples = 0;
  for (uint32_t y = frame->area.y; y < frame->area.y + frame->area.height; ++y) {
    for (uint32_t x = frame->area.x; x < frame->area.x + frame->area.width; ++x) {
      const size_t ray = (size_t)y * frame->rays_across + x;
      const float* entry = entries + 4 * ray;
      double hit, to_entry = 0.0;
      samples += cast_ray(self, entry, directions + 4 * ray, colours + 4 * ray, &hit);
      for (int axis = 0; axis < 3; ++axis) {
        const double along = ((double)entry[axis] - eye->eye[axis]) / eye->voxels_per_unit[axis];
        to_entry += along * along;
      }
      depths_m[ray] = (float)((sqrt(to_entry) + hit) * eye->eye[3]);
    }
  }
  if (frame->counted != NULL) {
    frame->counted->rays += (uint64_t)frame->area.width * frame->area.height;
    frame->counted->samples += samples;
  }
  return BRACE_OK;
}

static const char* last_error(void* self) {
  return ((const stage*)self)->error;
}

static const brace_cast_functions functions = {sizeof functions, NULL, execute, 0};

static const brace_stage_descriptor descriptor = {sizeof descriptor,
                                                  BRACE_KIND_CAST,
                                                  "@NAME@",
                                                  "0.1.0",
                                                  "Emission and absorption on the CPU, nearest voxel",
                                                  params,
                                                  P_COUNT,
                                                  create,
                                                  destroy,
                                                  &functions,
                                                  activate,
                                                  deactivate,
                                                  last_error};

static const brace_stage_descriptor* const stages[] = {&descriptor};

BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "@NAME@", "0.1.0", stages, 1);
}
