#include <nifti/nifti1_io.h>
#include <teem/nrrd.h>

#include "runtime/volume/statistics.hpp"
#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

struct Expected {
  std::string file;
  std::array<int, 3> dims;
  VoxelType type;
  std::array<double, 3> spacing;
  std::string orientation;
  ValueRange range;
};

class RealVolume : public testing::TestWithParam<Expected> {};

bool same_bytes(const Volume& volume, const void* theirs, std::size_t their_bytes) {
  return volume.voxels.size() == their_bytes && std::memcmp(volume.voxels.data(), theirs, their_bytes) == 0;
}

bool equals_teem(const Volume& volume, const std::string& path) {
  ::Nrrd* nrrd = nrrdNew();
  EXPECT_EQ(nrrdLoad(nrrd, path.c_str(), nullptr), 0);
  const bool equal = same_bytes(volume, nrrd->data, nrrdElementNumber(nrrd) * nrrdElementSize(nrrd));
  nrrdNuke(nrrd);
  return equal;
}

bool equals_nifticlib(const Volume& volume, const std::string& path) {
  nifti_image* image = nifti_image_read(path.c_str(), 1);
  if (image == nullptr) return false;
  const bool equal = same_bytes(volume, image->data, nifti_get_volsize(image));
  nifti_image_free(image);
  return equal;
}

TEST_P(RealVolume, ReadsAsTheOtherImplementationDoes) {
  if (shared_volumes().empty()) GTEST_SKIP() << "no real volumes: BRACE_SHARED_DIR is not set";
  const Expected& expected = GetParam();
  const std::string path = shared_volumes() / expected.file;
  const Volume volume = load(path);
  EXPECT_EQ(volume.info.dims, expected.dims);
  EXPECT_EQ(volume.info.type, expected.type);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(volume.info.spacing[axis], expected.spacing[axis], 1e-6);
  EXPECT_EQ(volume.info.orientation, expected.orientation);
  const VoxelStatistics statistics = scan(volume);
  EXPECT_EQ(statistics.range.min, expected.range.min);
  EXPECT_EQ(statistics.range.max, expected.range.max);
  const bool nifti = expected.file.ends_with(".nii.gz");
  EXPECT_TRUE(nifti ? equals_nifticlib(volume, path) : equals_teem(volume, path));
}

INSTANTIATE_TEST_SUITE_P(
    All, RealVolume,
    testing::Values(
        Expected{"mri_colin27_ch2better_301x370x316_u8.nii.gz",
                 {301, 370, 316},
                 VoxelType::uint8,
                 {0.5, 0.5, 0.5},
                 "RAS",
                 {0, 130}},
        Expected{"ct_cranium_256x256x108_i16.nrrd",
                 {256, 256, 108},
                 VoxelType::int16,
                 {0.9570312, 0.9570312, 1.5},
                 "LPS",
                 {-1024, 2986}},
        Expected{
            "ct_carp_256x512x256_u8.nii.gz", {256, 512, 256}, VoxelType::uint8, {1, 1, 1}, "RAS", {0, 254}},
        Expected{
            "ct_bonsai_256x256x256_u8.nrrd", {256, 256, 256}, VoxelType::uint8, {1, 1, 1}, "LPS", {0, 255}},
        Expected{"angio_aneurism_256x256x256_u8.nrrd",
                 {256, 256, 256},
                 VoxelType::uint8,
                 {1, 1, 1},
                 "LPS",
                 {0, 255}},
        Expected{"tooth.nhdr", {103, 94, 161}, VoxelType::uint16, {1, 1, 1}, "", {0, 1300}}),
    [](const auto& test) { return test.param.file.substr(0, test.param.file.find('.')); });

TEST(RealVolumes, AneurysmIsOnePercentOccupied) {
  if (shared_volumes().empty()) GTEST_SKIP() << "no real volumes: BRACE_SHARED_DIR is not set";
  const auto source = open_volume(shared_volumes() / "angio_aneurism_256x256x256_u8.nrrd");
  const VoxelStatistics statistics = scan(*source);
  const auto tf = load_transfer_function("tf1", preset_folder());
  const auto table = bake(resolve(tf, statistics.range), table_layout(statistics.type, statistics.range));
  EXPECT_NEAR(occupied_fraction(statistics, table), 0.0101, 1e-4);
}

}  // namespace
}  // namespace brace
