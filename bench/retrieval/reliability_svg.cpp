#include <algorithm>
#include <cstdio>

#include "bench/retrieval/calibration.hpp"

namespace landmarkdb::bench {

namespace {

// In pixels of the picture, y down. The diagram is a square, the histogram has its width.
constexpr double kLeft = 64.0;
constexpr double kTop = 24.0;
constexpr double kSide = 400.0;
constexpr double kCountsTop = kTop + kSide + 56.0;
constexpr double kCountsHeight = 90.0;
constexpr double kCountsBottom = kCountsTop + kCountsHeight;
constexpr double kWidth = kLeft + kSide + 24.0;
constexpr double kHeight = kCountsBottom + 24.0;

constexpr const char* kDark = "#1b1f24";
constexpr const char* kGrid = "#d5dae0";
constexpr const char* kBlue = "#1f5fa8";

template <typename... Values>
std::string print(const char* format, Values... values) {
  char text[300];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

double across(double confidence) { return kLeft + kSide * confidence; }
double up(double share) { return kTop + kSide * (1.0 - share); }

std::string line(
    double x0, double y0, double x1, double y1, const char* colour, const char* more = "") {
  return print("<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" stroke=\"%s\"%s/>\n",
               x0,
               y0,
               x1,
               y1,
               colour,
               more);
}

std::string words(double x, double y, const char* anchor, const std::string& text) {
  return print("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"%s\">", x, y, anchor) + text +
         "</text>\n";
}

std::string frame(double top, double height) {
  return print(
      "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"none\" "
      "stroke=\"%s\"/>\n",
      kLeft,
      top,
      kSide,
      height,
      kDark);
}

std::string axes() {
  std::string svg;
  for (int i = 0; i <= 5; ++i) {
    const double value = 0.2 * i;
    if (i > 0 && i < 5) {
      svg += line(across(value), up(0.0), across(value), up(1.0), kGrid);
      svg += line(across(0.0), up(value), across(1.0), up(value), kGrid);
    }
    svg += words(across(value), up(0.0) + 18.0, "middle", print("%.1f", value));
    svg += words(kLeft - 8.0, up(value) + 4.0, "end", print("%.1f", value));
  }
  svg += line(across(0.0), up(0.0), across(1.0), up(1.0), kDark, " stroke-dasharray=\"5 4\"");
  svg += frame(kTop, kSide);
  svg += words(across(0.5), up(0.0) + 38.0, "middle", "confidence (mean of the bin)");
  svg += print("<text transform=\"translate(%.2f %.2f) rotate(-90)\" text-anchor=\"middle\">",
               18.0,
               up(0.5)) +
         "share of right poses, 90 % interval</text>\n";
  return svg;
}

std::string point(const ReliabilityBin& bin) {
  constexpr double kCap = 4.0;
  const double x = across(bin.mean_confidence);
  const double low = up(bin.interval.low);
  const double high = up(bin.interval.high);
  const char* wide = " stroke-width=\"1.5\"";
  return line(x, low, x, high, kBlue, wide) + line(x - kCap, low, x + kCap, low, kBlue, wide) +
         line(x - kCap, high, x + kCap, high, kBlue, wide) +
         print("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"4.5\" fill=\"%s\"/>\n",
               x,
               up(bin.share_right()),
               kBlue);
}

std::string histogram(const std::vector<ReliabilityBin>& bins) {
  std::size_t most = 1;
  for (const ReliabilityBin& bin : bins) most = std::max(most, bin.count);
  constexpr double kRoomForCount = 16.0;
  std::string svg;
  for (const ReliabilityBin& bin : bins) {
    const double share = static_cast<double>(bin.count) / static_cast<double>(most);
    const double height = (kCountsHeight - kRoomForCount) * share;
    const double x0 = across(bin.low);
    const double x1 = across(bin.high);
    svg += print(
        "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\" "
        "fill-opacity=\"0.55\"/>\n",
        x0 + 2.0,
        kCountsBottom - height,
        x1 - x0 - 4.0,
        height,
        kBlue);
    svg += words((x0 + x1) / 2.0, kCountsBottom - height - 3.0, "middle", print("%zu", bin.count));
  }
  svg += frame(kCountsTop, kCountsHeight);
  svg += print("<text transform=\"translate(%.2f %.2f) rotate(-90)\" text-anchor=\"middle\">",
               18.0,
               kCountsTop + kCountsHeight / 2.0) +
         "queries</text>\n";
  return svg;
}

}  // namespace

std::string reliability_svg(const std::vector<ReliabilityBin>& bins) {
  std::string svg = print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
      "viewBox=\"0 0 %.0f %.0f\" ",
      kWidth,
      kHeight,
      kWidth,
      kHeight);
  svg += print("font-family=\"sans-serif\" font-size=\"12\" fill=\"%s\">\n", kDark);
  svg += "<title>Reliability of held-out confidences</title>\n";
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  svg += axes();
  for (const ReliabilityBin& bin : bins) {
    if (bin.count > 0) svg += point(bin);
  }
  svg += histogram(bins);
  return svg + "</svg>\n";
}

}  // namespace landmarkdb::bench
