#include "io/files/utf8.hpp"

#include <gmock/gmock.h>
#include <rapidcheck.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "paracal/error.hpp"
#include "paracal/io/csv_stream.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/store.hpp"
#include "paracal/io/tables.hpp"

namespace paracal::io::utf8_test {
namespace {

using testing::ElementsAre, testing::HasSubstr, testing::ThrowsMessage;

/// An independent judge: it takes nothing but UTF-8.
bool json_takes(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

TEST(Utf8, IsWhatJsonTakes) {
  for (int lead = 0; lead < 256; ++lead) {  // every first and second byte, with what may follow
    for (int second = 0; second < 256; ++second) {
      for (const std::string more : {"", "\x80", "\x80\xBF", "\x80\x80\x80", "a"}) {
        const std::string text = std::string{static_cast<char>(lead), static_cast<char>(second)} + more;
        ASSERT_EQ(is_utf8(text), json_takes(text)) << lead << " " << second << " " << more.size();
      }
    }
  }
  EXPECT_TRUE(rc::check("any bytes", [](const std::string& text) { RC_ASSERT(is_utf8(text) == json_takes(text)); }));
}

TEST(Utf8, OtherBytesAreEscaped) {
  EXPECT_EQ(with_other_bytes_decoded("Me\xDFpunkt 1"), "Me\xC3\x9Fpunkt 1");
  EXPECT_EQ(with_other_bytes_decoded("Me\xC3\x9Fpunkt \xE9\xE8"), "Me\xC3\x9Fpunkt \xC3\xA9\xC3\xA8");
  EXPECT_EQ(with_other_bytes_decoded("5 \x80 \x99 \x81"), "5 \xE2\x82\xAC \xE2\x84\xA2 \\x81");
  EXPECT_TRUE(rc::check("whatever came", [](const std::string& text) {
    RC_ASSERT(is_utf8(with_other_bytes_decoded(text)));
    if (is_utf8(text)) RC_ASSERT(with_other_bytes_decoded(text) == text);
  }));
}

std::string utf16(const std::u16string& text, bool big_endian) {
  std::string bytes;
  for (const char16_t unit : u"\xFEFF" + text) {
    const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xFF);
    bytes += big_endian ? std::string{high, low} : std::string{low, high};
  }
  return bytes;
}

/// Of "pose,..." in UTF-16: characters of one, two, three and four bytes.
const std::u16string kWide = u"pose,x_mm,y_mm,z_mm\r\nMe\u00DFpunkt \u20AC \U0001F4CF,1,2,3\r\n";
const std::string kNarrow = "pose,x_mm,y_mm,z_mm\r\nMe\xC3\x9Fpunkt \xE2\x82\xAC \xF0\x9F\x93\x8F,1,2,3\r\n";

TEST(Utf16, BecomesUtf8) {
  EXPECT_EQ(decoded(utf16(kWide, false)), kNarrow);
  EXPECT_EQ(decoded(utf16(kWide, true)), kNarrow);
  EXPECT_EQ(decoded(kNarrow), std::nullopt);
  EXPECT_EQ(decoded(std::string_view("\xFF")), std::nullopt);
}

/// Pieces end anywhere, within a character, too.
TEST(Utf16, PiecesOfAnyLength) {
  const std::string bytes = utf16(kWide, true).substr(2);
  for (const std::size_t size : {1u, 2u, 3u, 7u}) {
    Utf16Decoder decoder(true);
    std::string text;
    for (std::size_t at = 0; at < bytes.size(); at += size) decoder.add(std::string_view(bytes).substr(at, size), text);
    decoder.finish();
    EXPECT_EQ(text, kNarrow) << size;
  }
}

TEST(Utf16, HalfCharactersAreRefused) {
  const auto refused = [](const std::u16string& text, std::size_t cut, const char* message) {
    std::string bytes = utf16(text, false);
    bytes.resize(bytes.size() - cut);
    EXPECT_THAT([&] { (void)decoded(bytes); }, ThrowsMessage<InvalidArgument>(HasSubstr(message)));
  };
  refused(u"ab", 1, "an incomplete character at its end");
  refused({u'a', char16_t{0xD83D}}, 0, "an incomplete character at its end");
  refused({u'a', char16_t{0xD83D}, u'b'}, 0, "an incomplete surrogate pair");
  refused({u'a', char16_t{0xDC00}}, 0, "an incomplete surrogate pair");
}

std::vector<std::string> streamed_names(const std::string& bytes) {
  std::istringstream in(bytes);
  CsvStream table({"p.csv", in});
  std::vector<std::string> names;
  read_poses(table, {}, [&](const Station& station) { names.push_back(station.name); });
  return names;
}

/// Longer than any buffer on the way.
TEST(Utf16, StreamsAreDecodedAsTheyAreRead) {
  std::u16string wide = u"pose,x_mm,y_mm,z_mm\n";
  for (int k = 0; k < 50'000; ++k) wide += u"P\u00DF" + std::u16string(1, char16_t('a' + k % 26)) + u",1,2,-800\n";
  std::istringstream in(utf16(wide, false));
  CsvStream table({"p.csv", in});
  std::size_t rows = 0;
  while (const CsvTable* row = table.next()) {
    ASSERT_EQ(row->text(0, "pose"), std::string("P\xC3\x9F") + static_cast<char>('a' + rows % 26));
    ++rows;
  }
  EXPECT_EQ(rows, 50'000u);
  EXPECT_THAT(streamed_names(utf16(kWide, true)), ElementsAre("Me\xC3\x9Fpunkt \xE2\x82\xAC \xF0\x9F\x93\x8F"));
  std::string cut = utf16(kWide, true);
  cut.pop_back();
  EXPECT_THAT([&] { (void)streamed_names(cut); },
              ThrowsMessage<InputFileError>("p.csv: expected UTF-16 text, got an incomplete character at its end"));
}

/// Gives some bytes, and then no more though they are not all.
class BrokenBuffer : public std::streambuf {
 public:
  explicit BrokenBuffer(std::string bytes) : bytes_(std::move(bytes)) {
    setg(bytes_.data(), bytes_.data(), bytes_.data() + bytes_.size());
  }

 protected:
  int_type underflow() override { throw std::runtime_error("the disk is gone"); }

 private:
  std::string bytes_;
};

TEST(Utf16, AStreamThatBreaksOffIsNoTable) {
  BrokenBuffer buffer(utf16(kWide, false));
  std::istream in(&buffer);
  CsvStream table({"p.csv", in});
  EXPECT_THAT([&] { (void)table.next(); }, ThrowsMessage<InputFileError>("p.csv: cannot be read to its end"));
}

/// What results say of their inputs is what sha256sum says.
TEST(Utf16, FilesAreHashedAsTheyAre) {
  const std::string path = testing::TempDir() + "paracal_wide.csv";
  const std::string bytes = utf16(u"pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\nP1,0,0,-888,1,2,3\n", false);
  write_file(path, bytes);
  const Measurements points = read_points(read_file(path));
  EXPECT_EQ(points.stations.at(0).name, "P1");
  EXPECT_EQ(points.files.at(0).sha256, sha256(bytes));
  write_file(path, bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT([&] { (void)read_file(path); },
              ThrowsMessage<InputFileError>(HasSubstr("an incomplete character at its end")));
}

TEST(Utf16, NoMarkIsNoUtf16) {
  for (const std::string begin : {"", "\xFF", "\xFE", "\xFF\xFF", "\xFE\xFE"}) {
    std::istringstream in(begin);
    EXPECT_EQ(decoded(in), nullptr) << begin.size();
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), begin);
  }
}

TEST(Latin1, NamesAndCommentsAreRead) {
  const std::string poses =
      "# Stra\xDF"
      "e\npose,x_mm,y_mm,z_mm\nMe\xDF 1,0,0,-888\nP2,1,0,-888\n";
  EXPECT_EQ(read_poses({"p.csv", poses}).at(0).name, "Me\xC3\x9F 1");
  EXPECT_THAT(streamed_names(poses), ElementsAre("Me\xC3\x9F 1", "P2"));
  const Measurements points = read_points({"m.csv",
                                           "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\n"
                                           "P1,0,0,-888,1,2,3\nMe\xDF,0,0,-888,4,5,6\nL\xE4,1,0,-888,7,8,9\n"});
  EXPECT_EQ(points.stations.at(1).name, "Me\xC3\x9F");
  const std::string note = "line 3: bytes that are not UTF-8 are read as Windows-1252 (Latin-1) from here on";
  EXPECT_THAT(points.notes, ElementsAre(note));
  const Measurements heights =
      read_lengths({"h.csv", "pose,height_mm\nMe\xDF 1,0.5\nP2,1\nP2,1.1\nP2,1.2\n"}, {"p.csv", poses});
  EXPECT_THAT(heights.notes, ElementsAre(HasSubstr("line 2: bytes"), "p.csv, " + note));
}

TEST(Latin1, InANumberItIsNone) {
  EXPECT_THAT(
      [] {
        (void)read_poses({"p.csv", "x_mm,y_mm,z_mm\n1,2\xB0,3\n"});
      },
      ThrowsMessage<InputFileError>(HasSubstr("p.csv:2: expected a finite number in column y_mm, got \"2\xC2\xB0\"")));
}

}  // namespace
}  // namespace paracal::io::utf8_test
