#include <numeric>

#include <teem/nrrd.h>

#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class Nrrd : public FolderTest {};

std::vector<std::int16_t> ramp(std::size_t count) {
  std::vector<std::int16_t> values(count);
  std::iota(values.begin(), values.end(), std::int16_t{-7});
  return values;
}

std::string nrrd_header(const std::string& more, const std::string& sizes = "3 2 4",
                        const std::string& type = "short") {
  return "NRRD0004\n# a comment\ntype: " + type + "\ndimension: 3\nsizes: " + sizes + "\n" + more;
}

/// What teem makes of the file; empty if it does not read it.
std::vector<double> read_by_teem(const std::filesystem::path& path) {
  ::Nrrd* nrrd = nrrdNew();
  std::vector<double> values;
  if (nrrdLoad(nrrd, path.c_str(), nullptr) == 0) {
    values.resize(nrrdElementNumber(nrrd));
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = nrrdDLookup[nrrd->type](nrrd->data, i);
  }
  nrrdNuke(nrrd);
  return values;
}

TEST_F(Nrrd, AttachedRawReadsInBothByteOrdersAsTeemDoes) {
  for (const bool big : {false, true}) {
    const auto path = write(
        "a.nrrd", nrrd_header(big ? "endian: big\nencoding: raw\n\n" : "endian: little\nencoding: raw\n\n") +
                      bytes_of(ramp(24), big));
    const Volume volume = load(path);
    EXPECT_EQ(volume.info.dims, (std::array<int, 3>{3, 2, 4}));
    EXPECT_EQ(volume.info.type, VoxelType::int16);
    EXPECT_EQ(voxel_value(volume, 0, 0, 0), -7);
    EXPECT_EQ(voxel_value(volume, 2, 1, 3), 16);
    EXPECT_EQ(voxel_value(volume, 1, 0, 0), -6) << "x is the fastest axis";
    EXPECT_EQ(values_of(volume), read_by_teem(path));
  }
}

TEST_F(Nrrd, GzipReadsAsTeemDoesAlsoWithSeveralMembers) {
  const std::string bytes = bytes_of(ramp(24));
  const auto one = write("one.nrrd", nrrd_header("endian: little\nencoding: gzip\n\n") + gzipped(bytes));
  EXPECT_EQ(values_of(load(one)), read_by_teem(one));
  const auto two = write("two.nrrd", nrrd_header("endian: little\nencoding: gz\n\n") +
                                         gzipped(bytes.substr(0, 13)) + gzipped(bytes.substr(13)));
  EXPECT_EQ(values_of(load(two)), values_of(load(one)));
}

TEST_F(Nrrd, DetachedHeaderSkipsLinesThenBytesAsTeemDoes) {
  const std::string bytes = bytes_of(ramp(24));
  write("d.dat", "first line\nsecond line\nxyz" + bytes);
  const auto skip =
      write("skip.nhdr",
            nrrd_header("endian: little\nencoding: raw\nline skip: 2\nbyte skip: 3\ndata file: d.dat\n"));
  EXPECT_EQ(voxel_value(load(skip), 0, 0, 0), -7);
  EXPECT_EQ(values_of(load(skip)), read_by_teem(skip));
  const auto end =
      write("end.nhdr", nrrd_header("endian: little\nencoding: raw\nbyteskip: -1\ndatafile: ./d.dat\n"));
  EXPECT_EQ(values_of(load(end)), read_by_teem(end));
  write("d.gz", gzipped("xyz" + bytes));
  const auto inside =
      write("z.nhdr", nrrd_header("endian: little\nencoding: gzip\nbyte skip: 3\ndata file: d.gz\n"));
  EXPECT_EQ(values_of(load(inside)), read_by_teem(inside));
}

TEST_F(Nrrd, SpacingComesFromSpacingsOrFromTheLengthOfDirections) {
  const std::string data = bytes_of(ramp(24));
  const std::string rest = "endian: little\nencoding: raw\n";
  const auto spacings = load(
      write("s.nrrd", nrrd_header(rest + "spacings: 0.5 -2 nan\nunits: \"mm\" \"mm\" \"mm\"\n\n") + data));
  EXPECT_EQ(spacings.info.spacing, (std::array<double, 3>{0.5, 2, 1}));
  EXPECT_EQ(spacings.info.spacing_unit, "mm");
  const auto directions =
      load(write("v.nrrd", nrrd_header(rest + "space: left-posterior-superior\n"
                                              "space directions: (0,3,4) (-2,0,0) (0,-0.4,0.3)\n\n") +
                               data));
  EXPECT_NEAR(directions.info.spacing[0], 5, 1e-12);
  EXPECT_NEAR(directions.info.spacing[1], 2, 1e-12);
  EXPECT_NEAR(directions.info.spacing[2], 0.5, 1e-12);
  EXPECT_EQ(directions.info.orientation, "SRA");
  EXPECT_EQ(directions.info.spacing_unit, "");
  EXPECT_EQ(voxel_length(directions.info), directions.info.spacing[2]);
  const auto size = box_size_with_longest_edge(directions.info, 0.6);
  EXPECT_NEAR(size[0], 0.6, 1e-15);  // 15 : 4 : 2
  EXPECT_NEAR(size[1], 0.16, 1e-15);
  EXPECT_NEAR(size[2], 0.08, 1e-15);
}

TEST_F(Nrrd, WindowsLineEndsAndKeyValuePairsAreRead) {
  const auto path = write("w.nrrd",
                          "NRRD0005\r\ntype: uchar\r\ndimension: 3\r\nsizes: 1 1 2\r\nencoding: raw\r\n"
                          "a key:=a: value\r\nother:=x\r\n\r\nAB");
  EXPECT_EQ(values_of(load(path)), (std::vector<double>{65, 66}));
}

TEST_F(Nrrd, TypesOutsideTheFourAreConvertedOnlyWhereThatIsExact) {
  const auto signed_bytes =
      load(write("i8.nrrd", nrrd_header("encoding: raw\n\n", "1 1 2", "signed char") + "\xff\x7f"));
  EXPECT_EQ(signed_bytes.info.type, VoxelType::int16);
  EXPECT_EQ(values_of(signed_bytes), (std::vector<double>{-1, 127}));
  EXPECT_EQ(signed_bytes.info.notes.size(), 1U);

  const std::string rest = "endian: little\nencoding: raw\n\n";
  const auto wide = load(
      write("u32.nrrd", nrrd_header(rest, "1 1 2", "uint") + bytes_of<std::uint32_t>({70000, 1U << 24})));
  EXPECT_EQ(wide.info.type, VoxelType::float32);
  EXPECT_EQ(values_of(wide), (std::vector<double>{70000, 16777216}));

  const auto inexact =
      write("bad.nrrd", nrrd_header(rest, "1 2 1", "uint") + bytes_of<std::uint32_t>({1, (1U << 24) + 1}));
  EXPECT_THAT(error_of(inexact),
              testing::AllOf(HasSubstr("bad.nrrd"), HasSubstr("(0, 1, 0)"), HasSubstr("16777217"),
                             HasSubstr("accepted: uint8, int16, uint16, float32")));
  const auto doubles = write("f64.nrrd", nrrd_header(rest, "1 1 2", "double") + bytes_of<double>({0.5, 0.1}));
  EXPECT_THAT(error_of(doubles), HasSubstr("(0, 0, 1)"));
  const auto huge = write("huge.nrrd", nrrd_header(rest, "1 1 1", "double") + bytes_of<double>({1e300}));
  EXPECT_THAT(error_of(huge), HasSubstr("cannot hold exactly"));
  const auto longs =
      write("i64.nrrd", nrrd_header(rest, "1 1 1", "int64") + bytes_of<std::int64_t>({INT64_MAX}));
  EXPECT_THAT(error_of(longs), HasSubstr("cannot hold exactly"));
}

TEST_F(Nrrd, ErrorsNameFileLineAndWhatIsAccepted) {
  const std::string rest = "endian: little\nencoding: raw\n\n";
  const std::string data = bytes_of(ramp(24));
  const auto error = [&](const std::string& text) { return error_of(write("e.nrrd", text)); };
  EXPECT_THAT(error(nrrd_header(rest, "3 0 4") + data), HasSubstr("e.nrrd:5: sizes: dimension 1 is 0"));
  EXPECT_THAT(error(nrrd_header(rest, "3 -2 4") + data), HasSubstr("dimension 1 is -2"));
  EXPECT_THAT(error(nrrd_header(rest, "3 2") + data), HasSubstr("2 dimensions given (accepted: 3)"));
  EXPECT_THAT(error(nrrd_header(rest, "65536 65536 1") + data), HasSubstr("too many"));
  EXPECT_THAT(error(nrrd_header(rest, "4294967296 4294967296 4294967296") + data), HasSubstr("too many"));
  EXPECT_THAT(error(nrrd_header(rest, "99999999999999999999 1 1") + data), HasSubstr("too large"));
  EXPECT_THAT(error(nrrd_header(rest) + data.substr(1)),
              testing::AllOf(HasSubstr("48 bytes"), HasSubstr("found 47")));
  EXPECT_THAT(error(nrrd_header("endian: little\nencoding: bzip2\n\n") + data),
              HasSubstr("unknown encoding 'bzip2' (accepted: raw, gzip)"));
  EXPECT_THAT(error(nrrd_header("endian: middle\nencoding: raw\n\n") + data),
              HasSubstr("accepted: little, big"));
  EXPECT_THAT(error(nrrd_header("encoding: raw\n\n") + data), HasSubstr("'endian' is missing"));
  EXPECT_THAT(error(nrrd_header("encodng: raw\n\n") + data), HasSubstr("did you mean 'encoding'"));
  EXPECT_THAT(error(nrrd_header("encoding: raw\nencoding: raw\n\n") + data), HasSubstr("given twice"));
  EXPECT_THAT(error(nrrd_header(rest, "3 2 4", "block") + data), HasSubstr("accepted: uint8"));
  EXPECT_THAT(error(nrrd_header("spacings: 0 1 1\n" + rest) + data), HasSubstr("a spacing of 0"));
  EXPECT_THAT(error(nrrd_header("space directions: (1,0,0) none (0,0,1)\n" + rest) + data),
              HasSubstr("three vectors"));
  EXPECT_THAT(error(nrrd_header("data file: gone.raw\n" + rest)),
              HasSubstr("gone.raw: there is no such file"));
  EXPECT_THAT(error(nrrd_header("data file: LIST\n" + rest)), HasSubstr("accepted: one data file"));
  EXPECT_THAT(
      error(nrrd_header("line skip: 3\ndata file: e.nrrd\nencoding: raw\nendian: little\nline skip: 1\n")),
      HasSubstr("given twice"));
}

TEST_F(Nrrd, DamagedOrShortGzipIsAnErrorWithBytesExpectedAndFound) {
  const std::string packed = gzipped(bytes_of(ramp(24)));
  const std::string text = nrrd_header("endian: little\nencoding: gzip\n\n");
  EXPECT_THAT(error_of(write("short.nrrd", text + packed.substr(0, packed.size() / 2))),
              HasSubstr("truncated"));
  const auto few = error_of(write("few.nrrd", text + gzipped(bytes_of(ramp(20)))));
  EXPECT_THAT(few, testing::AllOf(HasSubstr("need 48 bytes"), HasSubstr("found 40")));
  std::string damaged = packed;
  damaged[damaged.size() - 6] = static_cast<char>(~damaged[damaged.size() - 6]);  // the checksum
  EXPECT_THAT(error_of(write("crc.nrrd", text + damaged)), HasSubstr("damaged"));
}

}  // namespace
}  // namespace brace
