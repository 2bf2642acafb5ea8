// Runs a fuzz target without libFuzzer: on every file of the folders, and on mutations of each.
// usage: replay_<target> [--mutations N] FOLDER...
//
// The mutations are the same in every run. Exit code 1 without any input; a finding aborts the
// program.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                                                     std::size_t size,
                                                                     std::size_t max_size,
                                                                     unsigned int seed);

namespace {

std::minstd_rand& random_numbers() {
  static std::minstd_rand random(1);
  return random;
}

std::vector<std::uint8_t> read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::filesystem::path> files_in(const std::vector<std::string>& folders) {
  std::vector<std::filesystem::path> files;
  for (const std::string& folder : folders) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.is_regular_file()) {
        files.push_back(entry.path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

// A minimal replacement for the interface of libFuzzer to custom mutators.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size,
                                        std::size_t max_size) {
  auto& random = random_numbers();
  const auto anywhere = [&] { return size == 0 ? 0 : random() % size; };
  switch (random() % 4) {
    case 0:
      return anywhere();  // cut
    case 1:
      if (size < max_size) {
        data[size] = static_cast<std::uint8_t>(random());
        return size + 1;
      }
      [[fallthrough]];
    case 2:
      if (size > 0) {
        data[anywhere()] = static_cast<std::uint8_t>(random());
      }
      return size;
    default:
      if (size > 0) {
        data[anywhere()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      }
      return size;
  }
}

int main(int argc, char** argv) {
  unsigned mutations = 0;
  std::vector<std::string> folders;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--mutations") == 0 && i + 1 < argc) {
      mutations = static_cast<unsigned>(std::strtoul(argv[++i], nullptr, 10));
    } else {
      folders.emplace_back(argv[i]);
    }
  }
  std::size_t runs = 0;
  for (const std::filesystem::path& path : files_in(folders)) {
    const std::vector<std::uint8_t> original = read_file(path);
    std::fprintf(stderr, "%s\n", path.filename().c_str());
    LLVMFuzzerTestOneInput(original.data(), original.size());
    ++runs;
    for (unsigned seed = 1; seed <= mutations; ++seed, ++runs) {
      std::vector<std::uint8_t> input = original;
      input.resize(original.size() + 64);
      std::size_t size = original.size();
      for (unsigned stack = 0; stack <= seed % 3; ++stack) {
        size = LLVMFuzzerCustomMutator != nullptr
                   ? LLVMFuzzerCustomMutator(input.data(), size, input.size(), 1000U * seed + stack)
                   : LLVMFuzzerMutate(input.data(), size, input.size());
      }
      LLVMFuzzerTestOneInput(input.data(), size);
    }
  }
  std::printf("%zu runs\n", runs);
  return runs > 0 ? 0 : 1;
}
