#include <functional>
#include <random>

#include <nifti/nifti1.h>

#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

// Damaged headers: whatever comes, the answer is a volume or brace::Error with exit code 2, and nothing is
// allocated before the file's size has been held against the header.

class Malformed : public FolderTest {};

constexpr std::size_t small_bytes = std::size_t{4} << 20;

/// Replaces, inserts, removes and swaps pieces of `text`.
std::string mutated(std::string text, const std::vector<std::string>& pieces, std::mt19937& random) {
  const auto below = [&](std::size_t bound) { return static_cast<std::size_t>(random()) % bound; };
  for (std::size_t change = 1 + below(5); change > 0; --change) {
    const std::size_t at = below(text.size() + 1);
    switch (below(4)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, below(12));
        break;
      case 2:
        text.insert(at, pieces[below(pieces.size())]);
        break;
      default:
        text.resize(at);
        break;
    }
    if (text.empty()) text.push_back('\n');
  }
  return text;
}

/// How many of the damaged files were read all the same.
int read_mutants(const std::string& seed, const std::vector<std::string>& pieces, int count,
                 const std::function<std::string(const std::string&)>& store) {
  std::mt19937 random(11);
  int read = 0;
  for (int i = 0; i < count; ++i) {
    const std::string path = store(mutated(seed, pieces, random));
    reset_largest_allocation();
    try {
      const Volume volume = load(path, {NonFinitePolicy::treat_as_empty, {}});
      EXPECT_EQ(volume.voxels.size(), volume.info.byte_count());
      ++read;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
      EXPECT_STRNE(error.what(), "");
    }
    EXPECT_LT(largest_allocation_bytes(), small_bytes);
  }
  return read;
}

const std::vector<std::string> text_pieces{"-1",
                                           "0",
                                           "99999999999",
                                           "nan",
                                           "inf",
                                           "1e400",
                                           "(1,2)",
                                           "\n",
                                           "\n\n",
                                           "none",
                                           "gzip",
                                           "raw",
                                           "LIST",
                                           "%03d",
                                           "float",
                                           "MET_DOUBLE",
                                           ": ",
                                           ":=",
                                           " = ",
                                           "\r",
                                           "line skip: 9\n",
                                           "byte skip: -1\n",
                                           "HeaderSize = -1\n",
                                           "CompressedData = True\n",
                                           "sizes: 1 1 1\n",
                                           "DimSize = 1 1 1\n",
                                           "[",
                                           "]",
                                           "\"",
                                           "header_bytes = 9\n"};

TEST_F(Malformed, NrrdHeaders) {
  const std::string seed =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nspace: RAS\nspace directions: (1,0,0) (0,1,0) "
      "(0,0,2)\n"
      "endian: big\nencoding: raw\n\n" +
      std::string(48, 'v');
  const int read =
      read_mutants(seed, text_pieces, 700, [&](const auto& text) { return write("m.nrrd", text); });
  EXPECT_GT(read, 5);
  EXPECT_LT(read, 680);
}

TEST_F(Malformed, MetaImageHeaders) {
  const std::string seed =
      "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_FLOAT\nElementSpacing = 1 1 2\n"
      "ElementDataFile = LOCAL\n" +
      std::string(96, 'v');
  const int read =
      read_mutants(seed, text_pieces, 700, [&](const auto& text) { return write("m.mha", text); });
  EXPECT_GT(read, 5);
  EXPECT_LT(read, 680);
}

TEST_F(Malformed, Sidecars) {
  write("m.raw", std::string(24, 'v'));
  const std::string seed =
      "dims = [4, 3, 2]\ntype = \"uint8\"\nspacing = [1, 1, 2]\nendian = \"big\"\nheader_bytes = 0\n";
  const int read = read_mutants(seed, text_pieces, 500, [&](const auto& text) {
    write("m.raw.toml", text);
    return (folder / "m.raw").string();
  });
  EXPECT_GT(read, 0);
  EXPECT_LT(read, 490);
}

TEST_F(Malformed, NiftiHeaders) {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  const std::int16_t dims[8] = {3, 4, 3, 2, 1, 1, 1, 1};
  std::memcpy(header.dim, dims, sizeof(dims));
  header.datatype = 4;
  header.bitpix = 16;
  header.vox_offset = 352;
  header.qform_code = header.sform_code = 1;
  std::memcpy(header.magic, "n+1", 4);
  std::string seed(400, 'v');
  std::memcpy(seed.data(), &header, sizeof(header));
  std::mt19937 random(5);
  int read = 0;
  testing::internal::CaptureStderr();
  for (int i = 0; i < 1000; ++i) {
    std::string file = seed;
    for (std::size_t change = 1 + random() % 6; change > 0; --change) {
      if (random() % 4 == 0) {
        const float odd[] = {1e38F, -1e38F, 0, std::numeric_limits<float>::quiet_NaN()};
        std::memcpy(file.data() + 4 * (random() % 87), &odd[random() % 4], 4);
      } else {
        file[random() % 348] = static_cast<char>(random());
      }
    }
    if (random() % 8 == 0) file.resize(random() % 400);
    reset_largest_allocation();
    try {
      const auto path = write("m.nii", random() % 2 == 0 ? gzipped(file) : file);
      load(path, {NonFinitePolicy::treat_as_empty, {}});
      ++read;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    }
    EXPECT_LT(largest_allocation_bytes(), small_bytes);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "nifticlib writes nothing of its own";
  EXPECT_GT(read, 30);
  EXPECT_LT(read, 970);
}

TEST_F(Malformed, HeadersThatAskForMuchAreHeldAgainstTheFileFirst) {
  const std::string text = "NRRD0004\ntype: double\ndimension: 3\nsizes: 2048 1024 1024\nendian: little\n";
  reset_largest_allocation();
  EXPECT_THAT(error_of(write("raw.nrrd", text + "encoding: raw\n\nabc")), testing::HasSubstr("found 3"));
  EXPECT_THAT(
      error_of(write("gz.nrrd", std::string(text).append("encoding: gzip\n\n").append(gzipped("abc")))),
      testing::HasSubstr("more than the file can unpack to"));
  EXPECT_THAT(error_of(write("end.nrrd", text + "byte skip: -1\nencoding: raw\n\nabc")),
              testing::HasSubstr("truncated"));
  EXPECT_LT(largest_allocation_bytes(), small_bytes);
}

}  // namespace
}  // namespace brace
