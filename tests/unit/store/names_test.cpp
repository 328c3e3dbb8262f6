#include "store/names.hpp"

#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;
using ::testing::HasSubstr;

TEST(ValidateName, AcceptsWordsOfAnyScript) {
  for (const char* name : {"a", "lobby", "Main hall 2.OG", "Empfang Süd", "入口", "-x", "a.b_c"}) {
    EXPECT_NO_THROW(validate_name(name, "scene name")) << name;
  }
}

TEST(ValidateName, CountsCharactersNotBytes) {
  std::string umlauts;
  for (int i = 0; i < 128; ++i) umlauts += "ü";
  EXPECT_NO_THROW(validate_name(umlauts, "scene name"));
  const auto thrown = error_of([&] { validate_name(umlauts + "u", "scene name"); });
  EXPECT_EQ(thrown.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(thrown.message, HasSubstr("129 characters"));
}

TEST(ValidateName, RefusesWhatCannotBeSeenOrTyped) {
  const std::vector<std::string> bad{"",
                                     " lobby",
                                     "lobby ",
                                     "a/b",
                                     "a\nb",
                                     "a\tb",
                                     std::string("a\0b", 3),
                                     "a\x7f",
                                     "a\xc2\x85",      // a C1 control
                                     "a\xe2\x80\x8b",  // a zero-width space
                                     "a\xe2\x80\xae",  // turns the text's direction
                                     "\xef\xbb\xbf"
                                     "a"};  // a byte order mark
  for (const std::string& name : bad) {
    EXPECT_EQ(error_of([&] { validate_name(name, "scene name"); }).code,
              ErrorCode::kInvalidArgument)
        << name;
  }
}

TEST(ValidateName, RefusesBytesThatAreNotUtf8) {
  const std::vector<std::string> bad{"\xff",
                                     "a\x80",
                                     "\xc0\xaf",          // '/' in two bytes
                                     "\xe0\x80\xaf",      // '/' in three
                                     "\xed\xa0\x80",      // a surrogate
                                     "\xf4\x90\x80\x80",  // past the last character
                                     "\xe2\x82"};         // cut off
  for (const std::string& name : bad) {
    EXPECT_THAT(error_of([&] { validate_name(name, "scene name"); }).message,
                HasSubstr("not valid UTF-8"));
  }
}

TEST(ValidateTagValue, AllowsSpacesAndSlashesButNoControls) {
  EXPECT_NO_THROW(validate_tag_value(""));
  EXPECT_NO_THROW(validate_tag_value(" building 7 / floor 2 "));
  EXPECT_EQ(error_of([] { validate_tag_value("a\x1b[2J"); }).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([] { validate_tag_value(std::string(1025, 'x')); }).code,
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace landmarkdb
