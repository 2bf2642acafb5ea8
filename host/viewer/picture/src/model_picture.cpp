#include "tactree/picture/model_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactree::picture {
namespace {

using core::Vec3;

// Drawn at twice the size and then halved, for smooth edges.
constexpr int kOver = 2;
constexpr int kMargin = 40;
constexpr int kCaption = 70;
constexpr std::size_t kDrawnMarks = 8;
constexpr int kMarkRadius = 13;
constexpr int kLegendTop = kMargin / 2;
constexpr int kLegendRow = 22;
constexpr int kLegendColumn = 300;
constexpr std::size_t kLegendRows = 4;
constexpr int kLetter = 12;  // width of a letter of 2 pixels per dot
constexpr Colour kPaper{0.965F, 0.969F, 0.975F};
constexpr Colour kInk{0.16F, 0.2F, 0.25F};
constexpr Colour kOutside{0.83F, 0.77F, 0.69F};
constexpr Colour kInside{0.42F, 0.47F, 0.55F};
constexpr Colour kHole{0.84F, 0.1F, 0.15F};
constexpr Colour kDoubtful{0.62F, 0.33F, 0.85F};
constexpr Colour kBoundary{0.93F, 0.55F, 0.06F};

/// Orthographic view of the model, in which the scale holds everywhere.
struct Eye {
  Vec3 right;
  Vec3 up;
  Vec3 forward;  ///< from the eye to the model
};

/// Direction of a view, from the model to the eye; z is up.
struct Direction {
  float yaw_rad;
  float pitch_rad;
};

Eye eye_from(Direction direction) {
  const float yaw_rad = direction.yaw_rad;
  const float level = std::cos(direction.pitch_rad);
  const Vec3 towards{level * std::cos(yaw_rad), level * std::sin(yaw_rad),
                     std::sin(direction.pitch_rad)};
  const Vec3 right{-std::sin(yaw_rad), std::cos(yaw_rad), 0.0F};
  return {right, core::cross(towards, right), -towards};
}

/// The first view, slightly from above and beside the front, +x. The outside of a surface that
/// faces one side as a whole, such as a relief or a sheet, is seen in it.
Direction first_view(const core::BlobView& view) {
  constexpr float kBeside_rad = 0.5F;
  constexpr float kPitch_rad = 0.35F;
  constexpr float kFacing = 0.5F;  // minimum mean of the normals; that of a closed body is 0
  Vec3 mean{};
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    mean = mean + view.surface_point(leaf, index).normal;
  });
  mean = (1.0F / static_cast<float>(view.point_count())) * mean;
  const float sideways = std::hypot(mean.x, mean.y);
  return {kBeside_rad + (sideways > kFacing ? std::atan2(mean.y, mean.x) : 0.0F),
          mean.z < -kFacing ? -kPitch_rad : kPitch_rad};
}

/// What the colours of the points tell; see draw_model().
struct Dress {
  std::span<const std::uint8_t> doubtful;
  std::span<const MaterialKey> materials;
  std::span<const std::array<std::uint8_t, 3>> colours;

  [[nodiscard]] bool is_plain() const { return materials.empty() && colours.empty(); }
  [[nodiscard]] bool has_doubts() const {
    return std::find(doubtful.begin(), doubtful.end(), 1) != doubtful.end();
  }
  /// The outside of a point.
  [[nodiscard]] Colour outside(const core::BlobView& view, std::uint32_t index) const {
    if (!materials.empty()) {
      return materials[view.material_of(index)].colour;
    }
    if (colours.empty()) {
      return kOutside;
    }
    const auto& [red, green, blue] = colours[index];
    return {static_cast<float>(red) / 255.0F, static_cast<float>(green) / 255.0F,
            static_cast<float>(blue) / 255.0F};
  }
};

Vec3 vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

Vec3 unit(Vec3 v) { return (1.0F / core::length(v)) * v; }

/// A mark as a view shows it.
struct NumberedMark {
  const Mark* mark;
  std::size_t number;
  float opacity;
};

/// One view of the model in its part of the picture.
class Panel {
 public:
  /// `top`: above it lies the legend.
  Panel(Raster& raster, const core::BlobView& view, const Eye& eye, int left, int width, int top)
      : raster_(raster), view_(view), eye_(eye), left_(left), width_(width), top_(top) {
    const core::BlobHeader& h = view.header();
    const Vec3 low{h.bounds_min_m[0], h.bounds_min_m[1], h.bounds_min_m[2]};
    const Vec3 high{h.bounds_max_m[0], h.bounds_max_m[1], h.bounds_max_m[2]};
    middle_ = 0.5F * (low + high);
    const auto wide = static_cast<float>(width - 2 * kOver * kMargin);
    const auto tall = static_cast<float>(raster.height() - top - kOver * (2 * kMargin + kCaption));
    scale_ = std::min(wide / (2.0F * extent(eye.right)), tall / (2.0F * extent(eye.up)));
    x_ = static_cast<float>(left) + 0.5F * static_cast<float>(width);
    y_ = 0.5F * static_cast<float>(raster.height() + top - kOver * kCaption);
  }

  [[nodiscard]] float pixels_per_metre() const { return scale_; }

  void draw_points(const Dress& dress) {
    const float radius = std::max(0.9F * view_.header().spacing_m * scale_, 1.0F);
    core::for_each_point(view_, [&](const core::Leaf& leaf, std::uint32_t index) {
      const core::SurfacePoint p = view_.surface_point(leaf, index);
      const Vec3 at = seen(p.position);
      const bool is_doubtful = !dress.doubtful.empty() && dress.doubtful[index] != 0;
      const Colour outside = is_doubtful ? kDoubtful : dress.outside(view_, index);
      raster_.disc(at.x, at.y, radius, at.z,
                   shade(p.normal, outside, is_doubtful ? kDoubtful : kInside));
    });
  }

  /// Ratio of the points whose inside is seen, not counting those near the silhouette. After
  /// draw_points().
  [[nodiscard]] float inside_share() const {
    constexpr float kClear = 0.2F;
    const float tolerance_m = view_.header().spacing_m;
    std::uint32_t count = 0;
    core::for_each_point(view_, [&](const core::Leaf& leaf, std::uint32_t index) {
      const core::SurfacePoint p = view_.surface_point(leaf, index);
      const bool away = core::dot(p.normal, eye_.forward) > kClear;
      count += away && !is_hidden(seen(p.position), tolerance_m) ? 1U : 0U;
    });
    return static_cast<float>(count) / static_cast<float>(view_.point_count());
  }

  [[nodiscard]] bool hides(const Mark& mark) const {
    return is_hidden(seen(vector(mark.centre_m)), mark.diameter_m);
  }

  /// Draws the numbered marks in the margin, each beside its place.
  void draw_marks(std::span<const NumberedMark> marks) {
    std::vector<Placed> sides[2];
    for (const NumberedMark& mark : marks) {
      const Vec3 at = seen(vector(mark.mark->centre_m));
      sides[at.x > x_ ? 1 : 0].push_back({&mark, at, at.y});
    }
    for (int side = 0; side < 2; ++side) {
      const int inset = kOver * kMargin / 2;
      const int x = side == 0 ? left_ + inset : left_ + width_ - inset;
      spread(sides[side]);
      for (const Placed& placed : sides[side]) {
        draw_mark(placed, static_cast<float>(x));
      }
    }
  }

 private:
  struct Placed {
    const NumberedMark* mark;
    Vec3 at;
    float y;  ///< of the number
  };

  /// Moves numbers apart, and into the part of the panel.
  void spread(std::vector<Placed>& marks) const {
    constexpr float kStep = 2.2F * kOver * kMarkRadius;
    const float low = static_cast<float>(top_ + kOver * kMargin);
    const float high = static_cast<float>(raster_.height() - kOver * (kCaption + kMarkRadius));
    std::sort(marks.begin(), marks.end(), [](const Placed& a, const Placed& b) {
      return a.y != b.y ? a.y < b.y : a.mark->number < b.mark->number;
    });
    float next = low;
    for (Placed& placed : marks) {
      placed.y = std::max(placed.y, next);
      next = placed.y + kStep;
    }
    float last = high;
    for (auto placed = marks.rbegin(); placed != marks.rend(); ++placed) {
      placed->y = std::min(placed->y, last);
      last = placed->y - kStep;
    }
  }

  void draw_mark(const Placed& placed, float x) {
    constexpr float kRadius = kOver * kMarkRadius;
    constexpr float kPlaceRadius = 6.0F;
    const Colour colour = placed.mark->mark->is_hole ? kHole : kBoundary;
    const float opacity = placed.mark->opacity;
    raster_.line(x, placed.y, placed.at.x, placed.at.y, 3.0F, colour, opacity);
    raster_.circle(placed.at.x, placed.at.y, 0.5F * kPlaceRadius, kPlaceRadius, colour, opacity);
    raster_.circle(x, placed.y, 0.5F * kRadius, kRadius, colour, opacity);
    const int dot = 2 * kOver - 1;
    raster_.text(static_cast<int>(x) - 5 * dot / 2, static_cast<int>(placed.y) - 7 * dot / 2,
                 fmt::format("{}", placed.mark->number), dot, kPaper);
  }

  /// Maximum distance of a point from the centre along a direction, to either side.
  [[nodiscard]] float extent(Vec3 direction) const {
    float largest = view_.header().spacing_m;
    core::for_each_point(view_, [&](const core::Leaf& leaf, std::uint32_t index) {
      const Vec3 p = view_.position(leaf, index) - middle_;
      largest = std::max(largest, std::abs(core::dot(p, direction)));
    });
    return largest;
  }

  /// x and y in pixels, z the depth in metres.
  [[nodiscard]] Vec3 seen(Vec3 position) const {
    const Vec3 p = position - middle_;
    return {x_ + scale_ * core::dot(p, eye_.right), y_ - scale_ * core::dot(p, eye_.up),
            core::dot(p, eye_.forward)};
  }

  [[nodiscard]] bool is_hidden(Vec3 at, float tolerance_m) const {
    const int x = static_cast<int>(at.x);
    const int y = static_cast<int>(at.y);
    return x >= 0 && y >= 0 && x < raster_.width() && y < raster_.height() &&
           raster_.depth(x, y) < at.z - tolerance_m;
  }

  [[nodiscard]] Colour shade(Vec3 normal, const Colour& front, const Colour& back) const {
    Vec3 n{core::dot(normal, eye_.right), core::dot(normal, eye_.up),
           -core::dot(normal, eye_.forward)};
    const bool outside = n.z >= 0.0F;
    n = outside ? n : -n;
    static const Vec3 kKey = unit({-0.45F, 0.6F, 0.65F});
    static const Vec3 kShine = unit({-0.25F, 0.35F, 0.9F});
    const float key = std::max(core::dot(n, kKey), 0.0F);
    const float fill = 0.5F + 0.5F * n.y;
    const float shine = 0.1F * std::pow(std::max(core::dot(n, kShine), 0.0F), 24.0F);
    const float light = 0.28F + 0.22F * fill + 0.6F * key;
    const Colour base = outside ? front : back;
    return {light * base.red + shine, light * base.green + shine, light * base.blue + shine};
  }

  Raster& raster_;
  const core::BlobView& view_;
  Eye eye_;
  int left_;
  int width_;
  int top_;
  Vec3 middle_{};
  float scale_ = 1.0F;
  float x_ = 0.0F;
  float y_ = 0.0F;
};

/// Draws a mark where the surface does not hide it; faintly in all views if it is hidden in each.
void draw_marks(std::vector<Panel>& panels, std::span<const Mark> marks) {
  constexpr float kFaint = 0.3F;
  std::vector<std::vector<NumberedMark>> shown(panels.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const bool hidden = std::all_of(panels.begin(), panels.end(),
                                    [&](const Panel& panel) { return panel.hides(marks[i]); });
    for (std::size_t k = 0; k < panels.size(); ++k) {
      if (hidden || !panels[k].hides(marks[i])) {
        shown[k].push_back({&marks[i], i + 1, hidden ? kFaint : 1.0F});
      }
    }
  }
  for (std::size_t k = 0; k < panels.size(); ++k) {
    panels[k].draw_marks(shown[k]);
  }
}

std::string length_text(float metres) {
  return metres >= 1.0F    ? fmt::format("{:g} m", metres)
         : metres >= 1e-3F ? fmt::format("{:g} mm", std::round(1e4F * metres) * 0.1F)
                           : fmt::format("{:g} um", std::round(1e7F * metres) * 0.1F);
}

/// 1, 2 or 5 times a power of ten, at most `longest`.
float round_length(float longest) {
  const float power = std::pow(10.0F, std::floor(std::log10(longest)));
  return longest >= 5.0F * power ? 5.0F * power : longest >= 2.0F * power ? 2.0F * power : power;
}

void draw_scale(Raster& raster, float pixels_per_metre) {
  const float bar_m = round_length(200.0F / pixels_per_metre);
  const int left = kMargin;
  const int bottom = raster.height() - 26;
  const int width = static_cast<int>(std::lround(bar_m * pixels_per_metre));
  raster.box(left, bottom - 3, left + width, bottom, kInk);
  raster.box(left, bottom - 10, left + 2, bottom, kInk);
  raster.box(left + width - 2, bottom - 10, left + width, bottom, kInk);
  raster.text(left + width + 14, bottom - 14, length_text(bar_m), 2, kInk);
}

std::string caption(const core::BlobHeader& h, std::span<const Mark> marks) {
  const auto holes =
      std::count_if(marks.begin(), marks.end(), [](const Mark& m) { return m.is_hole; });
  const auto boundaries = static_cast<std::ptrdiff_t>(marks.size()) - holes;
  return fmt::format("{} points, spacing {}, {} hole{}, {} open boundar{}", h.point_count,
                     length_text(h.spacing_m), holes, holes == 1 ? "" : "s", boundaries,
                     boundaries == 1 ? "y" : "ies");
}

void draw_caption(Raster& raster, const core::BlobHeader& header, std::span<const Mark> marks) {
  const std::string line = caption(header, marks);
  const int width = static_cast<int>(line.size()) * 12;
  raster.text(raster.width() - kMargin - width, raster.height() - 40, line, 2, kInk);
}

/// A line of the legend.
struct Key {
  std::optional<Colour> colour;
  std::string text;
};

void add_material_keys(std::vector<Key>& keys, const core::BlobView& view, const Dress& dress) {
  constexpr std::size_t kNamed = 8;
  std::vector<std::uint8_t> occurs(dress.materials.size(), 0);
  core::for_each_point(view, [&](const core::Leaf&, std::uint32_t index) {
    if (!occurs.empty()) {
      occurs[view.material_of(index)] = 1;
    }
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < occurs.size(); ++i) {
    if (occurs[i] != 0 && ++count <= kNamed) {
      keys.push_back({dress.materials[i].colour, dress.materials[i].name});
    }
  }
  if (count > kNamed) {
    keys.push_back({{}, fmt::format("and {} more materials", count - kNamed)});
  }
}

/// The colours in use. `sides`: both sides of the surface are seen.
std::vector<Key> legend(const core::BlobView& view, std::span<const Mark> drawn, std::size_t all,
                        const Dress& dress, bool sides) {
  std::vector<Key> keys;
  add_material_keys(keys, view, dress);
  if (dress.has_doubts()) {
    keys.push_back({kDoubtful, "ambiguous orientation"});
  }
  for (const bool hole : {true, false}) {
    if (std::any_of(drawn.begin(), drawn.end(),
                    [hole](const Mark& mark) { return mark.is_hole == hole; })) {
      keys.push_back({hole ? kHole : kBoundary, hole ? "hole" : "open boundary"});
    }
  }
  if (sides && dress.is_plain()) {
    keys.push_back({kOutside, "outside"});
  }
  if (sides) {
    keys.push_back({kInside, "inside"});
  }
  if (drawn.size() < all) {
    keys.push_back({{}, fmt::format("{} widest openings of {}", drawn.size(), all)});
  }
  return keys;
}

/// How much lower the model is drawn, to leave room for the legend.
int legend_room(std::size_t keys) {
  const int rows = static_cast<int>(std::min(keys, kLegendRows));
  return std::max(kLegendTop + kLegendRow * rows + 8 - kMargin, 0);
}

/// In columns, from the upper left corner.
void draw_legend(Raster& raster, std::span<const Key> keys) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    int left = kMargin + kLegendColumn * static_cast<int>(i / kLegendRows);
    const int top = kLegendTop + kLegendRow * static_cast<int>(i % kLegendRows);
    const int right = left + kLegendColumn - kLetter;
    if (keys[i].colour) {
      raster.box(left, top, left + 14, top + 14, *keys[i].colour);
      left += 24;
    }
    const auto room = static_cast<std::size_t>((right - left) / kLetter);
    raster.text(left, top, keys[i].text.substr(0, room), 2, kInk);
  }
}

/// Both views of the model.
struct Views {
  Views(const core::BlobView& view, const Dress& dress, int top)
      : raster(kOver * kPictureWidth, kOver * kPictureHeight, kPaper) {
    constexpr float kHalfTurn_rad = 3.14159265F;
    const Direction first = first_view(view);
    const int width = kOver * kPictureWidth / 2;
    for (int side = 0; side < 2; ++side) {
      const float yaw_rad = first.yaw_rad + static_cast<float>(side) * kHalfTurn_rad;
      panels.emplace_back(raster, view, eye_from({yaw_rad, first.pitch_rad}), side * width, width,
                          kOver * top);
      panels.back().draw_points(dress);
    }
  }
  Views(const Views&) = delete;  // the panels refer to the raster
  Views& operator=(const Views&) = delete;

  [[nodiscard]] bool shows_inside() const {
    constexpr float kInsideShare = 0.02F;  // less is seen through holes
    return std::any_of(panels.begin(), panels.end(),
                       [](const Panel& panel) { return panel.inside_share() > kInsideShare; });
  }

  Raster raster;
  std::vector<Panel> panels;
};

}  // namespace

Colour false_colour(std::size_t material) {
  constexpr Colour kColours[] = {
      {0.83F, 0.77F, 0.69F}, {0.86F, 0.37F, 0.34F}, {0.35F, 0.62F, 0.85F}, {0.47F, 0.73F, 0.38F},
      {0.89F, 0.72F, 0.30F}, {0.65F, 0.49F, 0.80F}, {0.30F, 0.70F, 0.67F}, {0.87F, 0.53F, 0.72F}};
  return kColours[material % std::size(kColours)];
}

Raster draw_model(const core::BlobView& view, std::span<const Mark> marks,
                  std::span<const std::uint8_t> doubtful, std::span<const MaterialKey> materials,
                  std::span<const std::array<std::uint8_t, 3>> colours) {
  const Dress dress{doubtful, materials, colours};
  const std::span<const Mark> drawn = marks.first(std::min(marks.size(), kDrawnMarks));
  std::vector<Key> keys = legend(view, drawn, marks.size(), dress, false);
  std::optional<Views> views(std::in_place, view, dress, legend_room(keys.size()));
  if (views->shows_inside()) {
    keys = legend(view, drawn, marks.size(), dress, true);
    views.emplace(view, dress, legend_room(keys.size()));
  }
  draw_marks(views->panels, drawn);
  Raster picture = views->raster.halved();
  draw_scale(picture, views->panels.back().pixels_per_metre() / static_cast<float>(kOver));
  draw_caption(picture, view.header(), marks);
  draw_legend(picture, keys);
  return picture;
}

}  // namespace tactree::picture
