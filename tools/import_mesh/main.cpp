// tactree-import-mesh FILE HINT MEMORY_BYTES CPU_SECONDS
// Reads the mesh FILE, whose content is what usually has the extension HINT, and writes it to
// standard output in the form of import_wire.hpp. Limits its own memory and time first. Started by
// the tactree builder, not by people.

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "contained_files.hpp"
#include "import_wire.hpp"
#include "scene_writer.hpp"

namespace tactree::import_mesh {
namespace {

using builder::WireHeader;
using builder::WireStatus;

constexpr int kExitRefused = 1;
constexpr int kExitUsage = 2;
constexpr int kExitOutOfMemory = 3;

int output = -1;  // standard output as it was at the start

// AddressSanitizer reserves terabytes of addresses, which no limit would let it have.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kLimitAddresses = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kLimitAddresses = false;
#else
constexpr bool kLimitAddresses = true;
#endif
#else
constexpr bool kLimitAddresses = true;
#endif

bool set_limit(int resource, rlim_t limit) {
  const rlimit both{limit, limit};
  return ::setrlimit(static_cast<__rlimit_resource>(resource), &both) == 0;
}

bool set_limits(const char* memory_bytes, const char* cpu_seconds) {
  const rlim_t memory = std::strtoull(memory_bytes, nullptr, 10);
  const rlim_t seconds = std::strtoull(cpu_seconds, nullptr, 10);
  if (memory == 0 || seconds == 0) return false;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // not to outlive the builder
  return (!kLimitAddresses || set_limit(RLIMIT_AS, memory)) && set_limit(RLIMIT_CPU, seconds) &&
         set_limit(RLIMIT_FSIZE, 0) && set_limit(RLIMIT_CORE, 0);
}

/// Needs no memory: also called when there is none.
void write_status(WireStatus status, const char* text) {
  WireHeader header;
  header.status = static_cast<std::uint32_t>(status);
  header.text_bytes =
      static_cast<std::uint32_t>(std::min<std::size_t>(std::strlen(text), builder::kMaxWireText));
  if (::write(output, &header, sizeof header) < 0) return;
  if (::write(output, text, header.text_bytes) < 0) return;
}

void out_of_memory() {
  write_status(WireStatus::kOutOfMemory, "");
  std::_Exit(kExitOutOfMemory);
}

void configure(Assimp::Importer& importer) {
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_TEXCOORDS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                  aiComponent_MATERIALS);
  // A scan stays in the frame of its file.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
}

int refuse(const char* text) {
  write_status(WireStatus::kRefused, text);
  return kExitRefused;
}

int import(const char* file, const char* hint) {
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(hint)) return refuse("the mesh library does not know it");
  configure(importer);
  auto* files = new ContainedFiles(file, hint);
  importer.SetIOHandler(files);  // which deletes it
  constexpr unsigned kSteps = aiProcess_ValidateDataStructure | aiProcess_RemoveComponent |
                              aiProcess_Triangulate | aiProcess_JoinIdenticalVertices;
  const aiScene* scene = importer.ReadFile(files->alias(), kSteps);
  if (scene == nullptr) {
    std::string reason = importer.GetErrorString();
    const std::size_t alias = reason.find(files->alias());
    if (alias != std::string::npos) reason.replace(alias, files->alias().size(), file);
    return refuse(reason.c_str());
  }
  std::FILE* to = ::fdopen(output, "wb");
  SceneWriter writer(*scene, to);
  if (writer.write()) return 0;
  return refuse("it holds no point and no face");
}

int run(int count, char** arguments) {
  if (count != 5) {
    std::fprintf(stderr, "usage: %s FILE HINT MEMORY_BYTES CPU_SECONDS\n", arguments[0]);
    return kExitUsage;
  }
  // Whatever the library prints must not get among the result.
  output = ::dup(STDOUT_FILENO);
  if (output < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return kExitUsage;
  if (!set_limits(arguments[3], arguments[4])) return refuse("its limits cannot be set");
  std::set_new_handler(out_of_memory);
  try {
    return import(arguments[1], arguments[2]);
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

}  // namespace
}  // namespace tactree::import_mesh

int main(int count, char** arguments) { return tactree::import_mesh::run(count, arguments); }
