#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class Raw : public FolderTest {};

TEST_F(Raw, SidecarDescribesTheFile) {
  const auto path = write("v.raw", "head" + bytes_of<std::int16_t>({1, -2, 300, 4}, true));
  write("v.raw.toml",
        "dims = [1, 4, 1]\ntype = \"int16\"\nspacing = [1, 0.5, 2]\nspacing_unit = \"um\"\nendian = \"big\"\n"
        "header_bytes = 4\n");
  for (const auto& name : {path.string(), path.string() + ".toml"}) {
    const Volume volume = load(name);
    EXPECT_EQ(values_of(volume), (std::vector<double>{1, -2, 300, 4}));
    EXPECT_EQ(volume.info.dims, (std::array<int, 3>{1, 4, 1}));
    EXPECT_EQ(volume.info.spacing, (std::array<double, 3>{1, 0.5, 2}));
    EXPECT_EQ(spacing_unit_m(volume.info), 1e-6);
  }
}

TEST_F(Raw, DimsThatDoNotMatchTheFileSizeAreAnErrorEitherWay) {
  const auto path = write("v.raw", std::string(24, 'x'));
  const auto error = [&](const std::string& sidecar) {
    write("v.raw.toml", sidecar);
    return error_of(path);
  };
  EXPECT_THAT(error("dims = [5, 5, 1]\ntype = \"uint8\"\n"), HasSubstr("need 25 bytes of data, found 24"));
  EXPECT_THAT(error("dims = [23, 1, 1]\ntype = \"uint8\"\n"),
              HasSubstr("the data has 24 bytes where 23 x 1 x 1"));
  EXPECT_THAT(error("dims = [24, 1, 1]\ntype = \"uint8\"\nheader_bytes = 1\n"), HasSubstr("found 23"));
  EXPECT_THAT(error("dims = [0, 1, 1]\ntype = \"uint8\"\n"),
              HasSubstr("v.raw.toml:1: dims: dimension 0 is 0"));
  EXPECT_THAT(error("dims = [1024, 1024, 4096]\ntype = \"uint8\"\n"), HasSubstr("too many"));
  EXPECT_THAT(error("dims = [24, 1, 1]\ntype = \"int12\"\n"), HasSubstr("'int12' (accepted: uint8"));
  EXPECT_THAT(error("dims = [24, 1, 1]\n"), HasSubstr("type"));
  EXPECT_THAT(error("dims = [24, 1]\ntype = \"uint8\"\n"), HasSubstr("2 dimensions"));
  EXPECT_THAT(error("dims = [2.5, 1, 1]\ntype = \"uint8\"\n"), HasSubstr("not an integer"));
  EXPECT_THAT(error("dims = [24, 1, 1]\ntype = \"uint8\"\nspacin = 1\n"),
              HasSubstr("did you mean 'spacing'"));
  EXPECT_THAT(error("dims = [24, 1, 1]\ntype = \"uint8\"\nspacing = [1, 0, 1]\n"),
              HasSubstr("a spacing of 0"));
  EXPECT_THAT(error("dims = [24, 1, 1]\ntype = \"uint8\"\nendian = \"pdp\"\n"),
              HasSubstr("accepted: little, big"));
  EXPECT_THAT(error("dims = [24, 1, 1]\ntype = \"uint8\"\nheader_bytes = -1\n"), HasSubstr("0 or more"));
  EXPECT_THAT(error("dims = [24, 1, 1\n"), HasSubstr("not valid TOML"));
}

TEST_F(Raw, MissingFilesAndSidecarsAreNamed) {
  const auto path = write("v.raw", "x");
  EXPECT_THAT(error_of(path), HasSubstr("needs a sidecar"));
  EXPECT_THAT(error_of(folder / "none.raw"), HasSubstr("none.raw: there is no such file"));
  EXPECT_THAT(error_of(folder / "none.nrrd"), HasSubstr("there is no such file"));
  EXPECT_THAT(error_of(folder.string()), HasSubstr("is not a regular file"));
  EXPECT_THAT(error_of(write("noise.bin", "what is this")), HasSubstr("accepted: .nrrd, .nhdr, .nii"));
}

}  // namespace
}  // namespace brace
