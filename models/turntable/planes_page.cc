// The picture to choose planes from.
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include "io/json_file.h"
#include "io/picture.h"
#include "io/units.h"
#include "models/turntable/planes_file.h"

namespace scancal::turntable {
namespace {

using Colour = std::array<uint8_t, 3>;

constexpr int32_t kMostWide = 1600, kMostHigh = 700, kShownWide = 1100, kShownHigh = 520;  // pixels
constexpr Colour kNothing = {255, 255, 255};

// By number; neighbouring ones differ in lightness, too (after Okabe and Ito, 2008).
constexpr std::array<Colour, 8> kColours = {{{230, 159, 0},
                                             {0, 114, 178},
                                             {0, 158, 115},
                                             {204, 51, 17},
                                             {86, 180, 233},
                                             {153, 80, 160},
                                             {150, 150, 0},
                                             {240, 120, 180}}};

Colour ColourOf(const FoundPlane& plane) { return kColours[static_cast<size_t>(plane.number - 1) % kColours.size()]; }

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text)
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  return escaped;
}

// A scan from left to right in profiles, from below in places along the line.
class Picture {
 public:
  Picture(const RangeImage& image, const PlanesOfScan& found) : image_(image), found_(found) {
    width_ = std::min(image.rows, kMostWide);
    height_ = std::min(image.columns, kMostHigh);
    shown_wide_ = std::max(width_, kShownWide);
    shown_high_ = std::clamp(static_cast<int>(std::lround(1.0 * shown_wide_ * height_ / width_)), 360, kShownHigh);
    owner_.assign(image.y.size(), -1);
    for (size_t k = 0; k < found.planes.size(); ++k)
      for (const int32_t p : found.planes[k].points) owner_[static_cast<size_t>(p)] = static_cast<int32_t>(k);
  }

  std::string Svg() const {
    constexpr int kLeft = 70, kBelow = 45, kAbove = 10;
    std::string svg = fmt::format(
        "<svg viewBox=\"{} {} {} {}\" role=\"img\" aria-label=\"range image\">\n<image width=\"{}\" height=\"{}\" "
        "preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>\n<rect width=\"{}\" height=\"{}\"/>\n",
        -kLeft, -kAbove, shown_wide_ + kLeft + 15, shown_high_ + kBelow + kAbove, shown_wide_, shown_high_,
        ToBase64(Png()), shown_wide_, shown_high_);
    svg += Axes();
    for (const FoundPlane& plane : found_.planes) {
      const auto [x, y] = MiddleOf(plane);
      svg += fmt::format("<text class=\"number\" x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", x, y, plane.number);
    }
    return svg + "</svg>\n";
  }

 private:
  double X(double row) const { return (row + 0.5) / image_.rows * shown_wide_; }
  double Y(double column) const { return (1 - (column + 0.5) / image_.columns) * shown_high_; }

  std::string Png() const {
    // Near is light. What is nearer or farther than most is as near or far as these.
    std::vector<double> depths;
    for (size_t p = 0; p < image_.y.size(); p += image_.y.size() / 100'000 + 1) depths.push_back(Depth(p));
    std::sort(depths.begin(), depths.end());
    const double near = depths[depths.size() / 50], far = depths[depths.size() - 1 - depths.size() / 50];
    std::vector<uint8_t> rgb;
    for (int32_t v = height_; v-- > 0;) {
      for (int32_t u = 0; u < width_; ++u) {
        const int32_t p = PointIn(u, v);
        Colour colour = kNothing;
        if (p >= 0) {
          const double share = (Depth(static_cast<size_t>(p)) - near) / std::max(far - near, 1e-9);
          const double grey = 215 - 150 * std::clamp(share, 0.0, 1.0);
          const int32_t owner = owner_[static_cast<size_t>(p)];
          for (size_t k = 0; k < 3; ++k)
            colour[k] = static_cast<uint8_t>(
                owner < 0 ? grey : 0.3 * grey + 0.7 * ColourOf(found_.planes[static_cast<size_t>(owner)])[k]);
        }
        rgb.insert(rgb.end(), colour.begin(), colour.end());
      }
    }
    return PngOf(static_cast<uint32_t>(width_), static_cast<uint32_t>(height_), rgb);
  }

  double Depth(size_t p) const { return image_.lidar ? std::hypot(image_.y[p], image_.z[p]) : image_.y[p]; }

  // The first point in the cells of a pixel, or -1.
  int32_t PointIn(int32_t u, int32_t v) const {
    const auto from = [](int32_t at, int32_t cells, int32_t pixels) {
      return static_cast<int32_t>(int64_t{at} * cells / pixels);
    };
    for (int32_t r = from(u, image_.rows, width_); r < from(u + 1, image_.rows, width_); ++r)
      for (int32_t c = from(v, image_.columns, height_); c < from(v + 1, image_.columns, height_); ++c)
        if (const int32_t p = image_.At(r, c); p >= 0) return p;
    return -1;
  }

  // Of its points the one nearest to their mean: a number stands on its plane.
  std::array<double, 2> MiddleOf(const FoundPlane& plane) const {
    double row = 0, column = 0;
    const auto count = static_cast<double>(plane.points.size());
    for (const int32_t p : plane.points) {
      row += image_.row[static_cast<size_t>(p)] / count;
      column += image_.column[static_cast<size_t>(p)] / count;
    }
    std::array<double, 2> nearest{};
    double least = -1;
    for (const int32_t p : plane.points) {
      const double x = X(image_.row[static_cast<size_t>(p)]), y = Y(image_.column[static_cast<size_t>(p)]);
      const double apart = std::hypot(x - X(row), y - Y(column));
      if (least >= 0 && apart >= least) continue;
      least = apart;
      nearest = {x, y};
    }
    return nearest;
  }

  std::string Axes() const {
    constexpr int kTicks = 9;
    std::string svg;
    for (int k = 0; k < kTicks; ++k) {
      const auto row = static_cast<size_t>(std::lround((image_.rows - 1.0) * k / (kTicks - 1)));
      svg += fmt::format("<text class=\"x\" x=\"{:.0f}\" y=\"{}\">{:.4g}</text>\n", X(static_cast<double>(row)),
                         shown_high_ + 17, image_.alpha[row] / kDegree);
    }
    for (int k = 0; k <= 4; ++k) {
      const double column = (image_.columns - 1.0) * k / 4;
      const double across = image_.first_across + column * image_.pitch;
      svg += fmt::format("<text class=\"y\" x=\"-6\" y=\"{:.0f}\">{:.4g}</text>\n", Y(column) + 4,
                         image_.lidar ? across / kDegree : across);
    }
    svg += fmt::format("<text class=\"x\" x=\"{}\" y=\"{}\">alpha / deg, profile after profile</text>\n",
                       shown_wide_ / 2, shown_high_ + 36);
    svg += fmt::format("<text class=\"x\" transform=\"translate(-52 {}) rotate(-90)\">{}</text>\n", shown_high_ / 2,
                       image_.lidar ? "bearing / deg" : "z / mm");
    for (size_t k = 1; k < image_.sweeps.size(); ++k)
      svg += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y2=\"{1}\"/>\n", X(image_.sweeps[k].first - 0.5),
                         shown_high_);
    return svg;
  }

  const RangeImage& image_;
  const PlanesOfScan& found_;
  int32_t width_, height_, shown_wide_, shown_high_;
  std::vector<int32_t> owner_;
};

std::string PlanesTable(const RangeImage& image, const PlanesOfScan& found) {
  std::string html = "<table>\n<tr><th>no.</th><th>name</th><th>points</th><th>profiles</th><th>alpha / deg</th><th>" +
                     std::string(image.lidar ? "bearing / deg" : "z / mm") +
                     "</th><th>rms along depth / mm</th><th>from the line of sight / deg</th></tr>\n";
  for (const FoundPlane& plane : found.planes) {
    const Colour colour = ColourOf(plane);
    const double unit = image.lidar ? kDegree : 1;
    html += fmt::format(
        "<tr><td><span style=\"background:rgb({},{},{})\">{}</span></td><td>{}</td><td>{}</td><td>{}</td><td>{:.4g} to "
        "{:.4g}</td><td>{:.4g} to {:.4g}</td><td>{:.3g}</td><td>{:.0f}</td></tr>\n",
        colour[0], colour[1], colour[2], plane.number, Escaped(NameOf(image, plane)), plane.points.size(),
        plane.profiles, plane.alpha[0] / kDegree, plane.alpha[1] / kDegree, plane.across[0] / unit,
        plane.across[1] / unit, plane.rms, 90 - plane.incidence / kDegree);
  }
  return html + "</table>\n";
}

}  // namespace

std::string PlanesPage(const std::vector<RangeImage>& images, const FoundPlanes& found) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Planes found</title>\n<style>\n"
      "body { font: 15px/1.45 sans-serif; max-width: 1200px; margin: 24px auto; padding: 0 16px; color: #111; }\n"
      "h1 { font-size: 22px; } h2 { font-size: 18px; margin-top: 32px; }\n"
      "svg { width: 100%; font: 15px sans-serif; } svg rect { fill: none; stroke: #888; }\n"
      "svg line { stroke: #111; stroke-dasharray: 5 4; } image { image-rendering: pixelated; }\n"
      ".x { text-anchor: middle; } .y { text-anchor: end; }\n"
      ".number { text-anchor: middle; dominant-baseline: central; font-weight: bold; font-size: 17px; stroke: #fff; "
      "stroke-width: 4; paint-order: stroke; }\n"
      "table { border-collapse: collapse; } th, td { padding: 3px 12px 3px 0; text-align: right; vertical-align: "
      "bottom; "
      "border-bottom: 1px solid #ddd; }\n"
      "td:nth-child(2), th:nth-child(2) { text-align: left; }\n"
      "td span { display: inline-block; min-width: 22px; text-align: center; color: #fff; font-weight: bold; "
      "text-shadow: "
      "0 0 3px #000; border-radius: 3px; }\n</style>\n</head>\n<body>\n<h1>Planes found</h1>\n<p>Each coloured region "
      "is "
      "one plane: a placement, where the data set names the file planes.yaml that lies beside this page. Take out of "
      "that "
      "file what is no plane of yours, what moved, and what is bent. Grey is what belongs to none, the lighter the "
      "nearer; "
      "white is what did not return. A dashed line is where the table turns round.</p>\n";
  for (size_t s = 0; s < images.size(); ++s) {
    const PlanesOfScan& of_scan = found.scans[s];
    html += "<h2>" + Escaped(images[s].name) + "</h2>\n" + Picture(images[s], of_scan).Svg();
    if (!of_scan.planes.empty()) html += PlanesTable(images[s], of_scan);
    html += fmt::format(
        "<p>{} points in {} profiles. Refused: {} regions that are bent or creased, {} within 15 degrees "
        "of edge-on.</p>\n",
        images[s].y.size(), images[s].rows, of_scan.bent, of_scan.edge_on);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace scancal::turntable
