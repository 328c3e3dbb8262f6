#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "datasets/picture/canvas.hpp"

namespace landmarkdb::datasets {
namespace {

// A glyph is drawn with strokes between points of a grid: a point is two digits, x and y, a bar
// starts another stroke. The base line is y = 2; small letters reach up to 6, capitals to 8.
struct Glyph {
  char character;
  int width;  // grid steps
  std::string_view strokes;
};

constexpr int kBaseLine = 2;
constexpr int kCapital = 6;    // grid steps from the base line to the top of a capital
constexpr int kSpacing = 2;    // between glyphs
constexpr float kPen = 0.13F;  // stroke width, share of a capital's height

constexpr auto kGlyphs = std::to_array<Glyph>({
    {' ', 2, ""},
    {'A', 4, "022842|1434"},
    {'B', 4, "02083847463505|3544433202"},
    {'C', 4, "4738180703123243"},
    {'D', 4, "02082847432202"},
    {'E', 4, "48080242|0535"},
    {'F', 4, "480802|0535"},
    {'G', 4, "47381807031232434525"},
    {'H', 4, "0208|4248|0545"},
    {'I', 2, "1218"},
    {'J', 4, "4843321203"},
    {'K', 4, "0208|480542"},
    {'L', 4, "080242"},
    {'M', 4, "0208254842"},
    {'N', 4, "02084248"},
    {'O', 4, "180703123243473818"},
    {'P', 4, "02083847453404"},
    {'Q', 4, "180703123243473818|2442"},
    {'R', 4, "02083847453404|2442"},
    {'S', 4, "473818070615354443321203"},
    {'T', 4, "0848|2822"},
    {'U', 4, "080312324348"},
    {'V', 4, "082248"},
    {'W', 4, "0812253248"},
    {'X', 4, "0248|0842"},
    {'Y', 4, "082548|2522"},
    {'Z', 4, "08480242"},
    {'a', 4, "4536160503123243|4642"},
    {'b', 4, "0802|0516364543321203"},
    {'c', 4, "4536160503123243"},
    {'d', 4, "4842|4536160503123243"},
    {'e', 4, "04444536160503123243"},
    {'f', 3, "38281712|0636"},
    {'g', 4, "4641301001|4536160503123243"},
    {'h', 4, "0802|0516364542"},
    {'i', 2, "1216|1818"},
    {'j', 2, "161100|1818"},
    {'k', 3, "0802|360432"},
    {'l', 2, "1812"},
    {'m', 6, "0602|0516263532|3546566562"},
    {'n', 4, "0602|0516364542"},
    {'o', 4, "160503123243453616"},
    {'p', 4, "0600|0516364543321203"},
    {'q', 4, "4640|4536160503123243"},
    {'r', 3, "0602|04152636"},
    {'s', 4, "45361605143443321203"},
    {'t', 3, "18132232|0636"},
    {'u', 4, "0603123243|4642"},
    {'v', 4, "062246"},
    {'w', 6, "0612355266"},
    {'x', 4, "0246|0642"},
    {'y', 4, "0622|4610"},
    {'z', 4, "06460242"},
    {'0', 4, "180703123243473818"},
    {'1', 4, "172822|1232"},
    {'2', 4, "07183847460242"},
    {'3', 4, "07183847463525|354443321203"},
    {'4', 4, "32380444"},
    {'5', 4, "480805354443321203"},
    {'6', 4, "473818070312324344351504"},
    {'7', 4, "084812"},
    {'8', 4, "180706153546473818|1504031232434435"},
    {'9', 4, "031232434738180706153546"},
    {'.', 2, "1212"},
    {',', 2, "1201"},
    {':', 2, "1313|1616"},
    {'-', 4, "1434"},
    {'+', 4, "0444|2226"},
    {'=', 4, "0545|0343"},
    {'/', 4, "0248"},
    {'(', 2, "27161423"},
    {')', 2, "07161403"},
    {'%', 4, "0248|0708171607|4342333443"},
    {'\'', 2, "1817"},
    {'_', 4, "0242"},
    {'<', 4, "460442"},
    {'>', 4, "064402"},
});

constexpr Glyph kUnknown = {'?', 4, "0208484202"};

const Glyph& glyph_of(char character) {
  const auto* found = std::find_if(kGlyphs.begin(), kGlyphs.end(), [&](const Glyph& glyph) {
    return glyph.character == character;
  });
  return found == kGlyphs.end() ? kUnknown : *found;
}

}  // namespace

void draw_text(Canvas& canvas,
               const Eigen::Vector2f& at,
               std::string_view text,
               float size,
               const Colour& colour) {
  const float step = size / static_cast<float>(kCapital);
  float left = at.x();
  for (const char character : text) {
    const Glyph& glyph = glyph_of(character);
    std::optional<Eigen::Vector2f> last;
    for (std::size_t i = 0; i < glyph.strokes.size(); ++i) {
      if (glyph.strokes[i] == '|') {
        last.reset();
        continue;
      }
      const auto x = static_cast<float>(glyph.strokes[i] - '0');
      const auto y = static_cast<float>(glyph.strokes[++i] - '0' - kBaseLine);
      const Eigen::Vector2f p(left + step * x, at.y() - step * y);
      draw_line(canvas, last.value_or(p), p, kPen * size, colour);
      last = p;
    }
    left += step * static_cast<float>(glyph.width + kSpacing);
  }
}

float text_width(std::string_view text, float size) {
  int steps = 0;
  for (const char character : text) steps += glyph_of(character).width + kSpacing;
  return size / static_cast<float>(kCapital) * static_cast<float>(std::max(0, steps - kSpacing));
}

}  // namespace landmarkdb::datasets
