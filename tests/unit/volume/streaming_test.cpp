#include <limits>

#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class Streaming : public FolderTest {};

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

std::string float_file(const std::string& sizes, const std::vector<float>& values) {
  return "NRRD0004\ntype: float\ndimension: 3\nsizes: " + sizes + "\nendian: little\nencoding: raw\n\n" +
         bytes_of(values);
}

TEST_F(Streaming, SlabsOfAnyThicknessMakeTheWholeVolume) {
  const std::string name = "generator:nested_shells:17x9x13:uint16";
  const Volume whole = load(name);
  for (const int thickness : {1, 2, 5, 13}) {
    const auto source = open_volume(name);
    std::vector<std::byte> joined;
    for (int z = 0; z < 13; z += thickness) {
      const int count = std::min(thickness, 13 - z);
      std::vector<std::byte> slab(static_cast<std::size_t>(count) * source->info().slice_bytes());
      source->read_slab(slab, z, count);
      joined.insert(joined.end(), slab.begin(), slab.end());
    }
    EXPECT_EQ(joined, whole.voxels);
    EXPECT_EQ(source->next_z(), 13);
  }
}

TEST_F(Streaming, ProgressRisesToOne) {
  const auto source = open_volume("generator:slab:512x512x64:float32");
  std::vector<double> fractions;
  load_volume(*source, [&](double fraction) { fractions.push_back(fraction); });
  EXPECT_GT(fractions.size(), 4U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1.0);
}

TEST_F(Streaming, NoAllocationGrowsWithTheVolume) {
  const std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 256 256 256\nencoding: gzip\n\n";
  const auto path = write("big.nrrd", text + gzipped(std::string(std::size_t{1} << 24, 'a')));
  std::vector<std::byte> slice(std::size_t{1} << 16);
  for (const std::string& name : {path.string(), std::string("generator:fractal_vessels:256")}) {
    reset_largest_allocation();
    const auto source = open_volume(name);
    for (int z = 0; z < 256; ++z)
      source->read_slab(slice, z, 1);
    EXPECT_LT(largest_allocation_bytes(), std::size_t{1} << 20) << name;
  }
}

TEST_F(Streaming, NonFiniteVoxelsAreRejectedWithFileAndPlace) {
  const auto nan = write("nan.nrrd", float_file("2 2 2", {1, 2, 3, 4, 5, 6, nan_value, 8}));
  EXPECT_THAT(error_of(nan), testing::AllOf(HasSubstr("nan.nrrd"), HasSubstr("voxel (0, 1, 1) is NaN")));
  const auto inf = write("inf.nrrd", float_file("2 1 1", {1, -infinite}));
  EXPECT_THAT(error_of(inf), HasSubstr("voxel (1, 0, 0) is infinite"));
}

TEST_F(Streaming, NonFiniteVoxelsBecomeTheEndsOfTheRangeWhenAsked) {
  const OpenOptions options{NonFinitePolicy::treat_as_empty, {}};
  const auto path = write("v.nrrd", float_file("3 2 1", {nan_value, 2, -3, infinite, -infinite, 0.5F}));
  const Volume volume = load(path, options);
  EXPECT_EQ(values_of(volume), (std::vector<double>{-3, 2, -3, 2, -3, 0.5}));
  ASSERT_EQ(volume.info.notes.size(), 1U);
  EXPECT_THAT(volume.info.notes[0], HasSubstr("3 voxels are NaN or infinite"));
  const auto none = write("none.nrrd", float_file("2 1 1", {nan_value, infinite}));
  EXPECT_EQ(values_of(load(none, options)), (std::vector<double>{0, 0}));
  const auto finite = write("finite.nrrd", float_file("2 1 1", {1, 2}));
  EXPECT_TRUE(load(finite, options).info.notes.empty());
}

TEST_F(Streaming, OneVoxelAndThinVolumesAreRead) {
  for (const std::string sizes : {"1 1 1", "1 7 1", "1 1 7", "7 1 1"}) {
    const std::size_t count = sizes == "1 1 1" ? 1 : 7;
    const std::vector<float> values(count, 4.5F);
    const Volume volume = load(write("thin.nrrd", float_file(sizes, values)));
    EXPECT_EQ(values_of(volume), std::vector<double>(count, 4.5));
  }
}

TEST_F(Streaming, SlabSlicesStayWithinTheBudget) {
  VolumeInfo info;
  info.dims = {1024, 1024, 795};
  EXPECT_EQ(slab_slices(info, std::size_t{16} << 20), 16);
  EXPECT_EQ(slab_slices(info, 1), 1);
  EXPECT_EQ(slab_slices(info, std::size_t{1} << 40), 795);
}

}  // namespace
}  // namespace brace
