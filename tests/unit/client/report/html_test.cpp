#include "client/report/html.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(HtmlText, EscapesWhatHasAMeaning) {
  EXPECT_EQ(html_text("<b>\"it's\" & so</b>"), "&lt;b&gt;&quot;it&#39;s&quot; &amp; so&lt;/b&gt;");
}

TEST(HtmlText, ReplacesWhatIsNoText) {
  EXPECT_EQ(html_text("a\xFF"
                      "b"),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(html_text(std::string("a\0b", 3)),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(html_text("\x1b[2J"), "\xEF\xBF\xBD[2J");
  EXPECT_EQ(html_text("Büro 3"), "Büro 3");
}

TEST(JsonForScript, CannotEndTheScriptAndReadsBackTheSame) {
  const nlohmann::ordered_json json = {{"name", "</script><!--<script>&\xE2\x80\xA8"},
                                       {"value", 0.1}};
  const std::string text = json_for_script(json);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_THAT(text, Not(HasSubstr(">")));
  EXPECT_THAT(text, Not(HasSubstr("&")));
  EXPECT_THAT(text, Not(HasSubstr("\xE2\x80\xA8")));
  EXPECT_EQ(nlohmann::ordered_json::parse(text), json);
}

TEST(Base64, IsTheOneOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

TEST(FillTemplate, LooksAtAValueOnlyOnce) {
  EXPECT_EQ(fill_template("a {{x}} b {{y}}", {{"x", "{{y}}"}, {"y", "2"}}), "a {{y}} b 2");
  EXPECT_EQ(fill_template("{{x", {}), "{{x");
  EXPECT_THROW(fill_template("{{z}}", {}), Error);
}

}  // namespace
}  // namespace landmarkdb::client
