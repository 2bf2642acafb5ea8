#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "run/simulate_run.hpp"
#include "run/simulate_setup.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/simulation/replay.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

/// Refuses traces and recordings of boards, which tell what a controller did. A replay needs what
/// reached it.
void refuse_tables(const std::string& file, const std::vector<std::byte>& header) {
  const std::string_view begin(reinterpret_cast<const char*>(header.data()), header.size());
  if (begin.starts_with("t_s,") || begin.starts_with("PK\x03\x04")) {
    refuse(
        fmt::format("{}: a trace, or the recording of a board, cannot be replayed: it has "
                    "positions and forces, but neither the configuration of the controller nor "
                    "the encoder counts and requests of its ticks",
                    file),
        fmt::format("tactree view BLOB --trace {0} shows it, simulate BLOB --path {0} repeats its "
                    "motion; simulate --record writes a file for --replay, also with --serve",
                    file));
  }
}

/// Checks the header before it reads the rest, because a file may have any size. Throws
/// simulation::RecordingError.
std::vector<std::byte> read_recording(const std::string& file) {
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  const std::uintmax_t size = in ? std::filesystem::file_size(file, error) : 0;
  if (!in || error) {
    refuse(
        fmt::format("{}: cannot be read: {}", file, error ? error.message() : std::strerror(errno)),
        "give a file that simulate --record wrote");
  }
  std::vector<std::byte> bytes;
  const auto read_to = [&](std::uintmax_t end) {
    const std::size_t begin = bytes.size();
    bytes.resize(static_cast<std::size_t>(end));
    if (!in.read(reinterpret_cast<char*>(bytes.data()) + begin,
                 static_cast<std::streamsize>(bytes.size() - begin))) {
      refuse(fmt::format("{}: truncated while it was being read", file),
             "wait until the recording is complete");
    }
  };
  read_to(std::min<std::uintmax_t>(size, simulation::kRecordingHeaderBytes));
  refuse_tables(file, bytes);
  simulation::check_recording_header(bytes, size);
  read_to(size);
  return bytes;
}

/// The blobs of the command line, in the order of the recording's models.
std::vector<core::BlobView> find_models(const SimulateOptions& options,
                                        const simulation::Recording& recording,
                                        const setup::SceneFile& scene) {
  std::vector<core::BlobView> models;
  for (const simulation::ModelDigest& wanted : recording.models()) {
    const support::BlobFile* found = nullptr;
    for (const support::BlobFile* const file : scene.files) {
      found = simulation::digest_of(file->bytes()) == wanted ? file : found;
    }
    if (found == nullptr) {
      refuse(
          fmt::format("{}: model {} of {} bytes, SHA-512 {:02x}..., is not one of the given blobs",
                      options.replay, models.size(), wanted.bytes,
                      fmt::join(wanted.hash.begin(), wanted.hash.begin() + 4, "")),
          "give every blob of the recorded session as BLOB");
    }
    models.push_back(found->view());
  }
  return models;
}

nlohmann::json to_json(const simulation::ReplayResult& result) {
  nlohmann::json differs;
  if (!result.same()) {
    differs = {{"tick", result.difference->tick}, {"cause", result.difference->cause}};
  }
  return {{"ticks", result.ticks},
          {"contact_ticks", result.summary.contact_ticks},
          {"trace_crc32", result.summary.trace_crc32},
          {"differs", differs}};
}

void print_result(const simulation::ReplayResult& result) {
  fmt::print("ticks              {}, {} of them in the trace\n", result.ticks,
             result.summary.ticks);
  fmt::print("trace checksum     {:08x}\n", result.summary.trace_crc32);
  if (result.same()) {
    fmt::print("result             every tick is identical to the recording\n");
  } else {
    fmt::print("result             differs from the recording at tick {}: {}\n",
               result.difference->tick, result.difference->cause);
  }
}

}  // namespace

bool replay_session(const SimulateOptions& options) {
  const setup::SceneFile scene = setup::read_scene(options.scene, options.blobs, options.pose);
  try {
    const std::vector<std::byte> bytes = read_recording(options.replay);
    simulation::Recording recording(bytes);
    const std::vector<core::BlobView> models = find_models(options, recording, scene);
    const simulation::ReplayResult result = simulation::replay(recording, models);
    if (!options.json.empty()) {
      support::write_file(options.json, support::json_text(to_json(result)));
    }
    print_result(result);
    return result.same();
  } catch (const simulation::RecordingError& error) {
    throw support::UserError(fmt::format("{}: {}", options.replay, error.what()));
  }
}

}  // namespace tactree::cli
