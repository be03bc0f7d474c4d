#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class MetaImage : public FolderTest {};

std::string header(const std::string& more, const std::string& file = "LOCAL",
                   const std::string& type = "MET_USHORT") {
  return "ObjectType = Image\nNDims = 3\nDimSize = 2 1 3\nElementType = " + type + "\n" + more +
         "ElementDataFile = " + file + "\n";
}

const std::vector<std::uint16_t> six{0, 1, 256, 40000, 65535, 7};
const std::vector<double> six_values{0, 1, 256, 40000, 65535, 7};

TEST_F(MetaImage, PlainZlibAndBigEndianReadTheSame) {
  const std::string bytes = bytes_of(six);
  EXPECT_EQ(values_of(load(write("a.mha", header("") + bytes))), six_values);
  EXPECT_EQ(values_of(load(write("z.mha", header("CompressedData = True\nCompressedDataSize = 99\n") +
                                              zlib_compressed(bytes)))),
            six_values);
  EXPECT_EQ(values_of(load(write("b.mha", header("BinaryDataByteOrderMSB = True\n") + bytes_of(six, true)))),
            six_values);
}

TEST_F(MetaImage, DetachedDataIsFoundBesideTheHeader) {
  const std::string bytes = bytes_of(six);
  write("d.raw", "1234" + bytes);
  const Volume skipped =
      load(write("a.mhd", header("HeaderSize = 4\nElementSpacing = 0.5 1 2.5\n", "d.raw")));
  EXPECT_EQ(values_of(skipped), six_values);
  EXPECT_EQ(skipped.info.spacing, (std::array<double, 3>{0.5, 1, 2.5}));
  EXPECT_EQ(skipped.info.spacing_unit, "mm");
  EXPECT_EQ(values_of(load(write("e.mhd", header("HeaderSize = -1\n", "d.raw")))), six_values);
  write("d.zraw", zlib_compressed(bytes));
  EXPECT_EQ(values_of(load(write("z.mhd", header("CompressedData = True\n", "d.zraw")))), six_values);
}

TEST_F(MetaImage, ErrorsSayWhatIsAccepted) {
  const std::string bytes = bytes_of(six);
  const auto error = [&](const std::string& text) { return error_of(write("e.mha", text)); };
  EXPECT_THAT(error(header("") + bytes.substr(2)), HasSubstr("need 12 bytes of data, found 10"));
  EXPECT_THAT(error(header("", "LOCAL", "MET_STRING") + bytes), HasSubstr("accepted: MET_ types of uint8"));
  EXPECT_THAT(error(header("ElementNumberOfChannels = 3\n") + bytes), HasSubstr("'3' (accepted: 1)"));
  EXPECT_THAT(error(header("BinaryData = False\n") + bytes), HasSubstr("accepted: True"));
  EXPECT_THAT(error(header("CompressedData = maybe\n") + bytes),
              HasSubstr("'maybe' (accepted: True, False)"));
  EXPECT_THAT(error(header("NDims = 3\n") + bytes), HasSubstr("given twice"));
  EXPECT_THAT(error(header("", "LIST") + bytes), HasSubstr("accepted: LOCAL or one data file"));
  EXPECT_THAT(error(header("", "gone.raw")), HasSubstr("gone.raw: there is no such file"));
  EXPECT_THAT(error("ObjectType = Image\nNDims = 2\nDimSize = 2 3\n"), HasSubstr("no ElementDataFile"));
  EXPECT_THAT(error("NDims = 2\nElementDataFile = LOCAL\n"), HasSubstr("e.mha:1: NDims: 2 (accepted: 3)"));
  EXPECT_THAT(error(header("CompressedData = True\n") + bytes), HasSubstr("damaged"));
}

}  // namespace
}  // namespace brace
