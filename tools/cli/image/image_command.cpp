#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "image/firmware_image.hpp"
#include "image/image_formats.hpp"
#include "image/own_board.hpp"
#include "option_checks.hpp"
#include "tactree/emulation/board_description.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct ImageOptions {
  std::string firmware;
  std::string blob;
  std::string output;
  std::string board;  ///< name, or JSON file of a board outside this tree
  std::string blob_at;
  std::string room;
  std::string uf2_family;
  std::string format;
  std::string usb = "ffff:ffff";
  std::string json;
};

void require_board(const ImageOptions& options, const std::string& name,
                   const FirmwareImage& image) {
  if (!name.empty() && name != image.board) {
    throw support::UserError(fmt::format(
        "{}: wrong board: this image is for {}, not for {} (give the image that was built for {})",
        options.firmware, image.board, name, name));
  }
}

/// Reads the firmware. The options state what it does not: room of the blob, family of the chip.
FirmwareImage read_image(const ImageOptions& options) {
  OwnBoard board;
  if (is_board_file(options.board)) {
    board = read_board_file(options.board);
  } else {
    board.name = options.board;
  }
  Unstated unstated{board.name, board.blob};
  if (!options.blob_at.empty()) {
    unstated.place = {number_of("--blob-at", options.blob_at), number_of("--room", options.room)};
  }
  FirmwareImage image = read_firmware(options.firmware, unstated);
  require_board(options, board.name, image);
  if (image.states_room && !options.blob_at.empty()) {
    throw support::UserError(
        fmt::format("{}: states the room of its blob itself, {} bytes from {:#010x} (leave "
                    "--blob-at and --room out)",
                    options.firmware, image.blob_end - image.blob_begin, image.blob_begin));
  }
  if (!options.uf2_family.empty()) {
    image.uf2_family = number_of("--uf2-family", options.uf2_family);
  } else if (image.uf2_family == 0U) {
    image.uf2_family = board.uf2_family;
  }
  return image;
}

/// The blob at the address where the image expects it.
Segment blob_segment(const ImageOptions& options, const FirmwareImage& image) {
  const support::BlobFile blob(options.blob);
  const std::uint32_t room = image.blob_end - image.blob_begin;
  if (blob.bytes().size() > room) {
    throw support::UserError(fmt::format(
        "{}: too large for {}: {} bytes, its flash has room for {} (build it with --flash-budget "
        "{}, or with a larger --spacing)",
        options.blob, image.board, blob.bytes().size(), room, room));
  }
  return {image.blob_begin, {blob.bytes().begin(), blob.bytes().end()}};
}

std::string format_of(const ImageOptions& options) {
  if (!options.format.empty()) {
    return options.format;
  }
  const std::string extension = std::filesystem::path(options.output).extension().string();
  for (const char* format : {"elf", "hex", "bin", "uf2", "dfu"}) {
    if (extension == std::string(".") + format) {
      return format;
    }
  }
  throw CLI::ValidationError("--output", "'" + options.output +
                                             "': cannot infer the format from the extension " +
                                             "(use .elf, .hex, .bin, .uf2 or .dfu, or --format)");
}

/// Refuses a large gap between code and blob, which formats without addresses fill.
void require_small_gap(const ImageOptions& options, const std::vector<Segment>& segments) {
  const std::uint64_t span = std::uint64_t{segments.back().address} + segments.back().bytes.size() -
                             segments.front().address;
  if (span > kMaxBinBytes) {
    throw support::UserError(fmt::format(
        "{}: {} bytes lie between the first and the last byte of this image, and the format has no "
        "addresses (use .elf, .hex or .uf2)",
        options.output, span));
  }
}

/// Without a family, a boot loader cannot tell an image for another chip. The boards of this tree
/// that have none are emulated.
void require_family(const ImageOptions& options, const FirmwareImage& image) {
  if (image.uf2_family == 0U && emulation::find_board(image.board) == nullptr) {
    throw support::UserError(fmt::format(
        "{}: the UF2 family of {} is unknown (state it in the image's record, in the board's file, "
        "or by --uf2-family, such as 0xE48BFF59 for an RP2350; "
        "github.com/microsoft/uf2 lists all)",
        options.firmware, image.board));
  }
}

std::uint16_t usb_number(const std::string& text) {
  return static_cast<std::uint16_t>(std::stoul(text, nullptr, 16));
}

std::vector<Segment> sorted(std::vector<Segment> segments, const Segment& blob) {
  if (!blob.bytes.empty()) {
    segments.push_back(blob);
  }
  std::sort(segments.begin(), segments.end(),
            [](const Segment& a, const Segment& b) { return a.address < b.address; });
  return segments;
}

std::vector<std::byte> encode(const ImageOptions& options, const FirmwareImage& image,
                              const Segment& blob) {
  const std::string format = format_of(options);
  if (format == "elf") {
    return blob.bytes.empty() ? image.file : to_elf(image.file, blob);
  }
  const std::vector<Segment> segments = sorted(image.segments, blob);
  if (format == "hex") {
    return to_hex(segments, image.entry);
  }
  if (format == "uf2") {
    require_family(options, image);
    return to_uf2(segments, image.uf2_family);
  }
  require_small_gap(options, segments);
  return format == "bin" ? to_bin(segments)
                         : to_dfu(segments, usb_number(options.usb.substr(0, 4)),
                                  usb_number(options.usb.substr(5, 4)));
}

void make_image(const ImageOptions& options) {
  support::check_outputs({options.output, options.json}, {options.firmware, options.blob});
  const FirmwareImage image = read_image(options);
  std::size_t code_bytes = 0;
  for (const Segment& segment : image.segments) {
    code_bytes += segment.bytes.size();
  }
  Segment blob;
  if (!options.blob.empty()) {
    blob = blob_segment(options, image);
  }
  const std::vector<std::byte> bytes = encode(options, image, blob);
  support::write_file(options.output, bytes);
  fmt::print("{}: for {}, {} bytes of code from {:#010x}, {} bytes of blob from {:#010x}\n",
             options.output, image.board, code_bytes, image.segments.front().address,
             blob.bytes.size(), image.blob_begin);
  if (!options.json.empty()) {
    const nlohmann::json result{{"board", image.board},
                                {"format", format_of(options)},
                                {"address", image.segments.front().address},
                                {"blob_address", image.blob_begin},
                                {"code_bytes", code_bytes},
                                {"blob_bytes", blob.bytes.size()},
                                {"file_bytes", bytes.size()}};
    support::write_file(options.json, support::json_text(result));
  }
}

}  // namespace

void add_image_command(CLI::App& app, int&) {
  auto options = std::make_shared<ImageOptions>();
  CLI::App* verb = app.add_subcommand(
      "image", "Puts firmware and blob into one file for a programmer or boot loader");
  verb->add_option("FIRMWARE", options->firmware, "image of a board, an ELF file")->required();
  verb->add_option("BLOB", options->blob,
                   "the model (default: write the firmware without a model)");
  verb->add_option("-o,--output", options->output, "file to write")->required();
  verb->add_option("--board", options->board,
                   "refuse an image of another board; a JSON file describes a board of your own");
  CLI::Option* at = verb->add_option(
      "--blob-at", options->blob_at,
      "address of the blob, for a firmware of your own that does not state it: 0x08020000");
  CLI::Option* room =
      verb->add_option("--room", options->room, "room for the blob at that address: 917504, 896K");
  at->needs(room);
  room->needs(at);
  verb->add_option("--uf2-family", options->uf2_family,
                   "ID of the chip in a UF2 file, for a board of your own: 0xE48BFF59");
  verb->add_option("--format", options->format, "default: by the extension of the output")
      ->check(one_of({"elf", "hex", "bin", "uf2", "dfu"}));
  verb->add_option("--usb", options->usb, "VENDOR:PRODUCT in the dfu suffix, hexadecimal")
      ->capture_default_str()
      ->check([](const std::string& text) {
        const bool good = text.size() == 9 && text[4] == ':' &&
                          text.find_first_not_of("0123456789abcdefABCDEF:") == std::string::npos &&
                          text.find(':') == 4 && text.rfind(':') == 4;
        return good ? std::string() : "--usb: four hexadecimal digits, a colon, four more";
      });
  verb->add_option("--json", options->json, "write a summary to this file");
  verb->callback([options] { make_image(*options); });
}

}  // namespace tactree::cli
