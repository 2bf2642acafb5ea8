#include "scan/board_build.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "image/board_costs.hpp"
#include "image/firmware_image.hpp"
#include "image/own_board.hpp"
#include "tactree/emulation/board_description.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;
using builder::BuildResult;

// The cost of a tick depends little on the number of points, so that sizes below 1/64 gain nothing.
constexpr int kHalvings = 6;
// Bisections between the minimum size that is too slow and the maximum size that is not. Initially
// they differ by a factor of 2.
constexpr int kRefinements = 3;

[[nodiscard]] BoardCosts costs_of(const BoardRequest& request) {
  if (request.firmware.empty()) {
    return costs_of_board(request.board);
  }
  return costs_of_image(request.firmware,
                        read_firmware(request.firmware, unstated_by(request.board)), request.board);
}

/// Room for the blob, bytes; nullopt if any size will do.
std::optional<std::uint64_t> room_of(const BoardRequest& request) {
  if (!request.firmware.empty()) {
    const FirmwareImage image = read_firmware(request.firmware, unstated_by(request.board));
    return image.blob_end - image.blob_begin;
  }
  if (const std::optional<BlobPlace> place = unstated_by(request.board).place) {
    return place->room;
  }
  const emulation::BoardDescription* const board = emulation::find_board(request.board);
  return board == nullptr ? std::nullopt : std::optional<std::uint64_t>(board->blob_bytes_max);
}

/// Checks whether a board keeps the requested rate with a model.
class RateCheck {
 public:
  explicit RateCheck(const BoardRequest& request) : request_(request), board_(costs_of(request)) {
    configuration_.rate_hz = static_cast<float>(request.rate_hz);
    configuration_.device = slowest_or(request.device);
  }

  [[nodiscard]] bool keeps_rate(const BuildResult& result) {
    const core::BlobView view = view_of(result);
    choose_mode(view);
    return board_.highest_rate(view.header(), configuration_) >= request_.rate_hz;
  }

  [[nodiscard]] const std::string& board() const { return board_.timing.board; }

  [[noreturn]] void refuse(const BuildResult& result) {
    const core::BlobView view = view_of(result);
    choose_mode(view);
    throw support::UserError(fmt::format(
        "--rate: {} renders this model at up to {:.0f} Hz, not at {:.6g} Hz: a tick takes up to "
        "{:.0f} cycles, the period has {:.0f} (lower --rate, choose a faster board{}: {} points in "
        "a ball dominate the cost)",
        board_.timing.board, std::floor(board_.highest_rate(view.header(), configuration_)),
        request_.rate_hz, board_.cycles(view.header(), configuration_),
        board_.timing.clock_hz / request_.rate_hz,
        request_.chooses_size ? "; a model with fewer points is no faster"
                              : ", or a larger --spacing",
        view.header().points_per_ball_max));
  }

 private:
  void choose_mode(const core::BlobView& view) {
    configuration_.mode = view.is_uniform() ? core::RenderMode::kSurface : core::RenderMode::kPaper;
  }

  const BoardRequest& request_;
  BoardCosts board_;
  core::Configuration configuration_;
};

/// Searches among models of other sizes than that of the first.
class SizeSearch {
 public:
  SizeSearch(std::span<const fs::path> inputs, const builder::BuildOptions& build, RateCheck& check,
             builder::Progress& progress)
      : inputs_(inputs), build_(build), check_(check), progress_(progress) {}

  /// The finest model below `too_large` bytes that keeps the rate; nullopt if there is none.
  [[nodiscard]] std::optional<BuildResult> below(double too_large) {
    std::optional<BuildResult> best;
    for (int i = 0; i < kHalvings && !best; ++i) {
      best = build_within(0.5 * too_large);
      too_large = best ? too_large : 0.5 * too_large;
    }
    for (int i = 0; i < kRefinements && best; ++i) {
      const double middle = std::sqrt(too_large * static_cast<double>(best->blob.bytes.size()));
      std::optional<BuildResult> finer = build_within(middle);
      if (finer && finer->blob.bytes.size() > best->blob.bytes.size()) {
        best = std::move(finer);
      } else {
        too_large = middle;
      }
    }
    return best;
  }

 private:
  [[nodiscard]] std::optional<BuildResult> build_within(double bytes) {
    build_.flash_budget_bytes = static_cast<std::uint64_t>(bytes);
    try {
      BuildResult result = builder::build_model(inputs_, build_, progress_);
      return check_.keeps_rate(result) ? std::optional(std::move(result)) : std::nullopt;
    } catch (const builder::BuildError&) {  // no model is that small
      return std::nullopt;
    }
  }

  std::span<const fs::path> inputs_;
  builder::BuildOptions build_;
  RateCheck& check_;
  builder::Progress& progress_;
};

}  // namespace

core::BlobView view_of(const BuildResult& result) {
  core::BlobView view;
  if (core::open_blob(result.blob.bytes, view) != core::BlobStatus::kOk) {
    throw support::UserError(
        "internal error: the written blob is not valid (report this with the input file)");
  }
  return view;
}

void limit_to_board(BoardRequest& request, builder::BuildOptions& build) {
  const std::optional<std::uint64_t> room = room_of(request);
  if (!room && is_board_file(request.board)) {
    fmt::print(stderr,
               "tactree: warning: {}: states no \"blob\", so that its flash does not limit the "
               "model (docs/PORTING.md)\n",
               request.board);
  }
  request.chooses_size =
      room.has_value() && build.resample && !build.spacing_m && !build.flash_budget_bytes;
  if (request.chooses_size) {
    build.flash_budget_bytes = room;
  }
}

BuildResult build_for_board(std::span<const fs::path> inputs, const builder::BuildOptions& build,
                            const BoardRequest& request, builder::Progress& progress) {
  BuildResult first = builder::build_model(inputs, build, progress);
  if (request.is_any() || request.rate_hz <= 0.0) {
    return first;
  }
  RateCheck check(request);
  if (check.keeps_rate(first)) {
    return first;
  }
  std::optional<BuildResult> found;
  if (request.chooses_size) {
    SizeSearch search(inputs, build, check, progress);
    found = search.below(static_cast<double>(first.blob.bytes.size()));
  }
  if (!found) {
    check.refuse(first);
  }
  found->report.notes.push_back(fmt::format(
      "{} has room for {} points of this scan, but at {:.6g} Hz it renders only a coarser model",
      check.board(), first.report.output_points, request.rate_hz));
  return std::move(*found);
}

}  // namespace tactree::cli
