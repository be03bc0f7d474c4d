#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace brace {

// Conventions. Voxel (i, j, k) lies at index i + dims[0] * (j + dims[1] * k): x fastest. A voxel is a cell:
// the volume's box has the edges dims * spacing, and voxel i's value stands at (i + 0.5) * spacing, as with a
// texel. "One voxel length" (steps, absorption) is the smallest of the three spacings.

enum class VoxelType : std::uint8_t { uint8, int16, uint16, float32 };

std::size_t bytes_per_voxel(VoxelType type);
std::string_view name_of(VoxelType type);

/// A volume may have at most this many voxels, so that 32-bit indices reach every one.
inline constexpr std::int64_t max_voxels = std::int64_t{1} << 31;

struct VolumeInfo {
  std::array<int, 3> dims{1, 1, 1};  // x, y, z; every one >= 1, product <= max_voxels
  VoxelType type = VoxelType::uint8;
  std::array<double, 3> spacing{1, 1, 1};  // in spacing_unit, finite and > 0
  std::string spacing_unit;                // "m", "mm", "um"; empty: the file states none
  std::string orientation;                 // where x, y, z point, such as "RAS" or "LPS"; empty: not stated
  std::string source;                      // path or generator, as given
  std::vector<std::string> notes;          // what the reader converted or left aside, for the report

  std::int64_t voxel_count() const;
  std::size_t slice_bytes() const;  // one z slice
  std::size_t byte_count() const;
};

/// dims * spacing, in spacing_unit.
std::array<double, 3> box_size(const VolumeInfo& info);

/// The box's edges scaled (aspect ratio kept) so that the longest one is `longest_edge`.
std::array<double, 3> box_size_with_longest_edge(const VolumeInfo& info, double longest_edge);

/// The smallest spacing, in spacing_unit.
double voxel_length(const VolumeInfo& info);

/// Length of spacing_unit in metres; empty if the file states none.
std::optional<double> spacing_unit_m(const VolumeInfo& info);

/// `fraction` goes from 0 to 1 and never falls.
using Progress = std::function<void(double fraction)>;

/// A volume on its way in: z slabs in order, host byte order, so that no second copy of a large volume is
/// needed.
class VolumeSource {
 public:
  virtual ~VolumeSource() = default;
  VolumeSource(const VolumeSource&) = delete;
  VolumeSource& operator=(const VolumeSource&) = delete;

  const VolumeInfo& info() const { return info_; }

  /// The first slice not read yet; dims[2] at the end.
  int next_z() const { return next_z_; }

  /// Slices z_begin .. z_begin + z_count - 1 into `out`, which has exactly z_count * info().slice_bytes()
  /// bytes. Forward only: z_begin == next_z(). Throws brace::Error (exit code 2) on truncated or damaged
  /// data, naming the file and the expected and found bytes.
  void read_slab(std::span<std::byte> out, int z_begin, int z_count);

 protected:
  explicit VolumeSource(VolumeInfo info);

 private:
  virtual void produce(std::span<std::byte> out, int z_begin, int z_count) = 0;

  VolumeInfo info_;
  int next_z_ = 0;
};

/// What becomes of NaN and infinite voxels of a float volume. No interpolation survives them, so a renderer
/// never sees one.
enum class NonFinitePolicy : std::uint8_t {
  reject,         // an error that names the file and the first such voxel
  treat_as_empty  // NaN and -Inf become the smallest finite value, +Inf the largest. Reads the data twice.
};

struct OpenOptions {
  NonFinitePolicy non_finite = NonFinitePolicy::reject;
  Progress progress;  // of a first pass over the data where one is needed (treat_as_empty); may be empty
};

/// Opens a NRRD (.nrrd, .nhdr), NIfTI-1 (.nii, .nii.gz), MetaImage (.mha, .mhd), raw file (.raw with a
/// sidecar .raw.toml) or "generator:NAME:SIZE[xSIZExSIZE][:TYPE]". The format goes by the file's first bytes,
/// then by its name. Header and file size are checked here, before anything of the data's size is allocated.
/// Throws brace::Error (exit code 2).
std::unique_ptr<VolumeSource> open_volume(const std::string& path_or_generator,
                                          const OpenOptions& options = {});

/// A whole volume in memory.
struct Volume {
  VolumeInfo info;
  std::vector<std::byte> voxels;  // info.byte_count() bytes, host byte order
};

/// The value of one voxel; the indices must be inside.
double voxel_value(const Volume& volume, int x, int y, int z);

/// Value of the voxel at `index` in a run of voxels of `type`.
double voxel_value(VoxelType type, std::span<const std::byte> voxels, std::size_t index);

Volume load_volume(VolumeSource& source, const Progress& progress = {});

/// Largest slab that keeps within `budget_bytes`; at least one slice.
int slab_slices(const VolumeInfo& info, std::size_t budget_bytes);

}  // namespace brace
