#include <limits>

#include <nifti/nifti1_io.h>

#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class Nifti : public FolderTest {};

nifti_1_header header_of(std::array<std::int16_t, 3> dims, std::int16_t datatype, std::int16_t bits) {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  header.dim[0] = 3;
  for (std::size_t i = 0; i < 3; ++i)
    header.dim[i + 1] = dims[i];
  for (int i = 4; i < 8; ++i)
    header.dim[i] = 1;
  header.datatype = datatype;
  header.bitpix = bits;
  header.pixdim[0] = 1;
  header.pixdim[1] = 0.5F;
  header.pixdim[2] = 0.75F;
  header.pixdim[3] = 3;
  header.vox_offset = 352;
  header.xyzt_units = NIFTI_UNITS_MM;
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

std::string file_of(const nifti_1_header& header, const std::string& data) {
  std::string bytes(352, '\0');
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes + data;
}

const std::vector<std::int16_t> six_signed{-300, -1, 0, 1, 2, 3000};

TEST_F(Nifti, PlainAndGzipReadTheSameWithSpacingUnitAndOrientation) {
  nifti_1_header header = header_of({3, 2, 1}, NIFTI_TYPE_INT16, 16);
  header.sform_code = 1;
  header.srow_x[1] = -0.75F;  // y grows to the left
  header.srow_y[0] = 0.5F;    // x grows to the front
  header.srow_z[2] = 3;
  const std::string file = file_of(header, bytes_of(six_signed));
  for (const auto& path : {write("a.nii", file), write("a.nii.gz", gzipped(file)), write("renamed", file)}) {
    const Volume volume = load(path);
    EXPECT_EQ(volume.info.dims, (std::array<int, 3>{3, 2, 1}));
    EXPECT_EQ(volume.info.spacing, (std::array<double, 3>{0.5, 0.75, 3}));
    EXPECT_EQ(volume.info.spacing_unit, "mm");
    EXPECT_EQ(spacing_unit_m(volume.info), 1e-3);
    EXPECT_EQ(volume.info.orientation, "ALS");
    EXPECT_EQ(values_of(volume), (std::vector<double>{-300, -1, 0, 1, 2, 3000}));
    EXPECT_TRUE(volume.info.notes.empty());
  }
}

TEST_F(Nifti, ByteSwappedFilesRead) {
  nifti_1_header header = header_of({3, 2, 1}, NIFTI_TYPE_INT16, 16);
  swap_nifti_header(&header, 1);
  const Volume volume = load(write("big.nii", file_of(header, bytes_of(six_signed, true))));
  EXPECT_EQ(volume.info.dims, (std::array<int, 3>{3, 2, 1}));
  EXPECT_EQ(values_of(volume), (std::vector<double>{-300, -1, 0, 1, 2, 3000}));
}

TEST_F(Nifti, ScaleOtherThanTheIdentityIsAppliedAndNoted) {
  nifti_1_header header = header_of({3, 2, 1}, NIFTI_TYPE_INT16, 16);
  header.scl_slope = 0.5F;
  header.scl_inter = 10;
  const Volume volume = load(write("s.nii", file_of(header, bytes_of(six_signed))));
  EXPECT_EQ(volume.info.type, VoxelType::float32);
  EXPECT_EQ(values_of(volume), (std::vector<double>{-140, 9.5, 10, 10.5, 11, 1510}));
  ASSERT_EQ(volume.info.notes.size(), 1U);
  EXPECT_THAT(volume.info.notes[0], HasSubstr("0.5 * stored + 10"));

  for (const auto& [slope, intercept] : {std::pair{1.0F, 0.0F}, std::pair{0.0F, 5.0F}}) {
    header.scl_slope = slope;
    header.scl_inter = intercept;
    EXPECT_EQ(load(write("i.nii", file_of(header, bytes_of(six_signed)))).info.type, VoxelType::int16)
        << "a slope of 0 means: no scale";
  }
}

TEST_F(Nifti, ReadsWhatNifticlibWrote) {
  const int dims[8] = {3, 4, 3, 2, 1, 1, 1, 1};
  nifti_image* image = nifti_make_new_nim(dims, NIFTI_TYPE_FLOAT32, 1);
  std::vector<double> expected;
  for (int i = 0; i < 24; ++i) {
    static_cast<float*>(image->data)[i] = 0.25F * static_cast<float>(i);
    expected.push_back(0.25 * i);
  }
  image->dx = image->pixdim[1] = 2;
  const auto path = folder / "lib.nii.gz";
  nifti_set_filenames(image, path.c_str(), 0, 0);
  nifti_image_write(image);
  nifti_image_free(image);
  const Volume volume = load(path);
  EXPECT_EQ(values_of(volume), expected);
  EXPECT_EQ(volume.info.spacing[0], 2);
}

TEST_F(Nifti, ErrorsSayWhatIsAccepted) {
  const std::string data = bytes_of(six_signed);
  const auto error = [&](auto&& change) {
    nifti_1_header header = header_of({3, 2, 1}, NIFTI_TYPE_INT16, 16);
    change(header);
    return error_of(write("e.nii", file_of(header, data)));
  };
  EXPECT_THAT(error([](auto& h) { h.dim[2] = 0; }), HasSubstr("dimension 1 is 0"));
  EXPECT_THAT(error([](auto& h) { h.dim[2] = -3; }), HasSubstr("dimension 1 is -3"));
  EXPECT_THAT(error([](auto& h) { h.dim[0] = 9; }), HasSubstr("dim[0] is 9 (accepted: 1 to 7)"));
  EXPECT_THAT(error([](auto& h) { h.dim[0] = 4, h.dim[4] = 2; }), HasSubstr("dim[4] is 2"));
  EXPECT_THAT(error([](auto& h) { h.dim[1] = h.dim[2] = h.dim[3] = 32767; }), HasSubstr("too many"));
  EXPECT_THAT(error([](auto& h) { h.dim[3] = 2; }), HasSubstr("need 24 bytes of data, found 12"));
  EXPECT_THAT(error([](auto& h) { h.datatype = NIFTI_TYPE_RGB24; }),
              HasSubstr("datatype 128 (accepted: uint8"));
  EXPECT_THAT(error([](auto& h) { h.pixdim[2] = std::numeric_limits<float>::infinity(); }),
              HasSubstr("a spacing of inf"));
  EXPECT_THAT(error([](auto& h) { h.vox_offset = -1; }), HasSubstr("vox_offset is -1"));
  EXPECT_THAT(error([](auto& h) { h.vox_offset = std::numeric_limits<float>::quiet_NaN(); }),
              HasSubstr("vox_offset is nan"));
  EXPECT_THAT(error([](auto& h) { h.sizeof_hdr = 540; }), HasSubstr("NIfTI-2"));
  EXPECT_THAT(error_of(write("short.nii", "abc")), HasSubstr("a NIfTI header has 348 bytes, found 3"));
  EXPECT_THAT(error_of(write("noise.nii.gz", std::string(400, 'x'))), HasSubstr("not a NIfTI-1 file"));
}

}  // namespace
}  // namespace brace
