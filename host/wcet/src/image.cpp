#include "image.hpp"

#include <cxxabi.h>
#include <dwarf.h>
#include <elfutils/libdw.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <gelf.h>
#include <unistd.h>

#include <cstdlib>
#include <set>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {

/// The handles of libelf and libdw, closed together.
class Image::Debug {
 public:
  explicit Debug(const std::filesystem::path& file) : name_(file.string()) {
    elf_version(EV_CURRENT);
    descriptor_ = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) {
      throw BoundError(name_ + ": cannot be read (give an image: <board>.elf)");
    }
    elf_ = elf_begin(descriptor_, ELF_C_READ, nullptr);
    GElf_Ehdr header;
    if (elf_ == nullptr || gelf_getehdr(elf_, &header) == nullptr || header.e_machine != EM_ARM ||
        header.e_type != ET_EXEC) {
      close_all();
      throw BoundError(name_ +
                       ": is not a linked image of an Arm core (other cores are not "
                       "supported)");
    }
    dwarf_ = dwarf_begin_elf(elf_, DWARF_C_READ, nullptr);
    if (dwarf_ == nullptr) {
      close_all();
      throw BoundError(name_ + ": has no line numbers (compile with -g)");
    }
  }
  ~Debug() { close_all(); }
  Debug(const Debug&) = delete;
  Debug& operator=(const Debug&) = delete;

  [[nodiscard]] Elf* elf() const { return elf_; }
  [[nodiscard]] Dwarf* dwarf() const { return dwarf_; }

  [[nodiscard]] std::vector<Dwarf_Die> units() const {
    std::vector<Dwarf_Die> result;
    Dwarf_Off offset = 0;
    Dwarf_Off next = 0;
    std::size_t header_size = 0;
    while (dwarf_nextcu(dwarf_, offset, &next, &header_size, nullptr, nullptr, nullptr) == 0) {
      Dwarf_Die unit;
      if (dwarf_offdie(dwarf_, offset + header_size, &unit) != nullptr) {
        result.push_back(unit);
      }
      offset = next;
    }
    return result;
  }

  /// Finds the compilation unit of an address. Returns false if the address has no line numbers.
  [[nodiscard]] bool unit_at(std::uint32_t address, Dwarf_Die& unit) const {
    return dwarf_addrdie(dwarf_, address, &unit) != nullptr;
  }

 private:
  void close_all() {
    if (dwarf_ != nullptr) {
      dwarf_end(dwarf_);
    }
    if (elf_ != nullptr) {
      elf_end(elf_);
    }
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }

  std::string name_;
  int descriptor_ = -1;
  Elf* elf_ = nullptr;
  Dwarf* dwarf_ = nullptr;
};

namespace {

/// Symbols of the functions inlined in a DIE and its children.
void collect_inlined(Dwarf_Die& entry, std::set<std::string>& names) {
  Dwarf_Attribute attribute;
  if (dwarf_tag(&entry) == DW_TAG_inlined_subroutine) {
    const char* const name =
        dwarf_formstring(dwarf_attr_integrate(&entry, DW_AT_linkage_name, &attribute));
    names.insert(name == nullptr ? "" : name);
  }
  Dwarf_Die child;
  if (dwarf_child(&entry, &child) == 0) {
    do {
      collect_inlined(child, names);
    } while (dwarf_siblingof(&child, &child) == 0);
  }
}

}  // namespace

Image::Image(const std::filesystem::path& file)
    : name_(file.string()), debug_(std::make_unique<Debug>(file)) {
  read_symbols();
}

Image::~Image() = default;

void Image::read_symbols() {
  Elf_Scn* section = nullptr;
  while ((section = elf_nextscn(debug_->elf(), section)) != nullptr) {
    GElf_Shdr header;
    if (gelf_getshdr(section, &header) == nullptr || header.sh_type != SHT_SYMTAB) {
      continue;
    }
    Elf_Data* const data = elf_getdata(section, nullptr);
    GElf_Sym symbol;
    for (int i = 0; gelf_getsym(data, i, &symbol) != nullptr; ++i) {
      const std::string name = elf_strptr(debug_->elf(), header.sh_link, symbol.st_name);
      const auto address = static_cast<std::uint32_t>(symbol.st_value);
      if (GELF_ST_TYPE(symbol.st_info) == STT_FUNC && symbol.st_size != 0) {
        const std::uint32_t begin = address & ~1U;
        functions_.try_emplace(
            begin, Function{name, begin, begin + static_cast<std::uint32_t>(symbol.st_size)});
      } else if (GELF_ST_TYPE(symbol.st_info) == STT_OBJECT) {
        variables_[name] = address;
      } else if (name == "$t" || name.starts_with("$t.")) {
        code_[address] = true;
      } else if (name == "$d" || name.starts_with("$d.") || name == "$a") {
        code_[address] = false;
      }
    }
  }
  if (functions_.empty()) {
    throw BoundError(name_ + ": has no symbols (do not strip it)");
  }
}

const Function* Image::function_at(std::uint32_t address) const {
  auto after = functions_.upper_bound(address);
  if (after == functions_.begin()) {
    return nullptr;
  }
  const Function& function = std::prev(after)->second;
  return address < function.end ? &function : nullptr;
}

namespace {

/// Whether a symbol is that of a whole function: as written, or with other arguments (.isra.0,
/// .constprop.0). Every other suffix is a fragment of one (.part.0, .cold).
bool is_whole(std::string_view symbol) {
  std::size_t at = symbol.find('.');
  while (at != std::string_view::npos) {
    const std::size_t end = symbol.find('.', at + 1);
    const std::string_view suffix = symbol.substr(at + 1, end - at - 1);
    const bool is_number = suffix.find_first_not_of("0123456789") == std::string_view::npos;
    if (suffix != "isra" && suffix != "constprop" && !is_number) {
      return false;
    }
    at = end;
  }
  return true;
}

/// The symbol as in the source, without the namespaces that have no name; empty for a fragment,
/// which the source does not name.
std::string name_in_source(const std::string& symbol) {
  static constexpr std::string_view kUnnamed = "(anonymous namespace)::";
  std::string name = is_whole(symbol) ? demangled(symbol) : std::string();
  for (std::size_t at = name.find(kUnnamed); at != std::string::npos; at = name.find(kUnnamed)) {
    name.erase(at, kUnnamed.size());
  }
  return name;
}

}  // namespace

const Function* Image::find(std::string_view name) const {
  for (const auto& [begin, function] : functions_) {
    if (function.name == name) {
      return &function;
    }
  }
  const Function* found = nullptr;
  for (const auto& [begin, function] : functions_) {
    const std::string in_source = name_in_source(function.name);
    if (in_source != name && in_source.substr(0, in_source.find('(')) != name) {
      continue;
    }
    if (found != nullptr) {
      throw BoundError(
          fmt::format("{}: {} and {} are both named {} (give a symbol, as nm prints it)", name_,
                      found->name, function.name, name));
    }
    found = &function;
  }
  return found;
}

std::optional<std::uint64_t> Image::offset_of(std::string_view symbol) const {
  const auto found = variables_.find(std::string(symbol));
  Elf_Scn* section = nullptr;
  while (found != variables_.end() && (section = elf_nextscn(debug_->elf(), section)) != nullptr) {
    GElf_Shdr header;
    if (gelf_getshdr(section, &header) != nullptr && header.sh_type == SHT_PROGBITS &&
        (header.sh_flags & SHF_ALLOC) != 0 && found->second >= header.sh_addr &&
        found->second - header.sh_addr < header.sh_size) {
      return header.sh_offset + (found->second - header.sh_addr);
    }
  }
  return std::nullopt;
}

std::span<const std::uint8_t> Image::bytes_at(std::uint32_t address) const {
  Elf_Scn* section = nullptr;
  while ((section = elf_nextscn(debug_->elf(), section)) != nullptr) {
    GElf_Shdr header;
    if (gelf_getshdr(section, &header) == nullptr || (header.sh_flags & SHF_ALLOC) == 0 ||
        header.sh_type != SHT_PROGBITS || address < header.sh_addr ||
        address - header.sh_addr >= header.sh_size) {
      continue;
    }
    const Elf_Data* const data = elf_getdata(section, nullptr);
    const std::uint64_t offset = address - header.sh_addr;
    return {static_cast<const std::uint8_t*>(data->d_buf) + offset,
            static_cast<std::size_t>(data->d_size - offset)};
  }
  return {};
}

bool Image::is_code(std::uint32_t address) const {
  auto after = code_.upper_bound(address);
  return after != code_.begin() && std::prev(after)->second;
}

std::vector<Place> Image::places(std::uint32_t address) const {
  std::vector<Place> result;
  Dwarf_Die unit;
  if (!debug_->unit_at(address, unit)) {
    return result;
  }
  if (Dwarf_Line* const line = dwarf_getsrc_die(&unit, address)) {
    int number = 0;
    const char* const file = dwarf_linesrc(line, nullptr, nullptr);
    if (file != nullptr && dwarf_lineno(line, &number) == 0) {
      result.push_back({file, static_cast<std::uint32_t>(number)});
    }
  }
  Dwarf_Files* files = nullptr;
  std::size_t file_count = 0;
  Dwarf_Die* scopes = nullptr;
  const int count = dwarf_getscopes(&unit, address, &scopes);
  if (dwarf_getsrcfiles(&unit, &files, &file_count) == 0) {
    for (int i = 0; i < count; ++i) {
      Dwarf_Attribute attribute;
      Dwarf_Word file = 0;
      Dwarf_Word line = 0;
      if (dwarf_tag(&scopes[i]) == DW_TAG_inlined_subroutine &&
          dwarf_formudata(dwarf_attr(&scopes[i], DW_AT_call_file, &attribute), &file) == 0 &&
          dwarf_formudata(dwarf_attr(&scopes[i], DW_AT_call_line, &attribute), &line) == 0) {
        const char* const name = dwarf_filesrc(files, file, nullptr, nullptr);
        result.push_back({name == nullptr ? "" : name, static_cast<std::uint32_t>(line)});
      }
    }
  }
  const std::unique_ptr<Dwarf_Die, decltype(&std::free)> owner(scopes, &std::free);
  return result;
}

std::set<std::string> Image::inlined_functions() const {
  std::set<std::string> names;
  for (Dwarf_Die unit : debug_->units()) {
    collect_inlined(unit, names);
  }
  return names;
}

std::vector<std::string> Image::source_files() const {
  std::set<std::string> names;
  for (Dwarf_Die unit : debug_->units()) {
    Dwarf_Files* files = nullptr;
    std::size_t count = 0;
    if (dwarf_getsrcfiles(&unit, &files, &count) == 0) {
      for (std::size_t i = 0; i < count; ++i) {
        const char* const name = dwarf_filesrc(files, i, nullptr, nullptr);
        names.insert(name == nullptr ? "" : name);
      }
    }
  }
  return {names.begin(), names.end()};
}

namespace {

/// Name of an argument. For a cloned function, it is the name in the original function.
std::string name_of(Dwarf_Die& argument) {
  const char* const name = dwarf_diename(&argument);
  Dwarf_Attribute attribute;
  Dwarf_Die origin;
  if (name != nullptr || dwarf_formref_die(dwarf_attr(&argument, DW_AT_abstract_origin, &attribute),
                                           &origin) == nullptr) {
    return name == nullptr ? "" : name;
  }
  const char* const original = dwarf_diename(&origin);
  return original == nullptr ? "" : original;
}

/// Words of an argument in core registers; 0 for a float, which is in an FPU register.
int words_of(Dwarf_Die& argument) {
  Dwarf_Attribute attribute;
  Dwarf_Die type;
  Dwarf_Word bytes = 0;
  Dwarf_Word encoding = 0;
  if (dwarf_formref_die(dwarf_attr_integrate(&argument, DW_AT_type, &attribute), &type) ==
          nullptr ||
      dwarf_aggregate_size(&type, &bytes) != 0) {
    return 1;
  }
  Dwarf_Die plain = type;
  dwarf_peel_type(&type, &plain);
  const bool is_float =
      dwarf_formudata(dwarf_attr(&plain, DW_AT_encoding, &attribute), &encoding) == 0 &&
      encoding == DW_ATE_float;
  return is_float ? 0 : static_cast<int>((bytes + 3) / 4);
}

}  // namespace

// The procedure call standard of Arm passes the first four words of arguments in r0 to r3.
std::map<std::string, int> Image::arguments(std::uint32_t entry) const {
  std::map<std::string, int> result;
  Dwarf_Die unit;
  Dwarf_Die* scopes = nullptr;
  if (!debug_->unit_at(entry, unit)) {
    return result;
  }
  const int count = dwarf_getscopes(&unit, entry, &scopes);
  for (int i = 0; i < count; ++i) {
    Dwarf_Die child;
    if (dwarf_tag(&scopes[i]) != DW_TAG_subprogram || dwarf_child(&scopes[i], &child) != 0) {
      continue;
    }
    int number = 0;
    do {
      if (dwarf_tag(&child) == DW_TAG_formal_parameter && number < 4) {
        const int words = words_of(child);
        const std::string name = name_of(child);
        if (words == 1) {
          result[name] = number;
        } else if (words == 2) {
          result[name + "_size"] = number + 1;
        }
        number += words;
      }
    } while (dwarf_siblingof(&child, &child) == 0);
    break;
  }
  const std::unique_ptr<Dwarf_Die, decltype(&std::free)> owner(scopes, &std::free);
  return result;
}

std::string demangled(const std::string& symbol) {
  int status = 0;
  const std::size_t clone = symbol.find('.');
  char* const text =
      abi::__cxa_demangle(symbol.substr(0, clone).c_str(), nullptr, nullptr, &status);
  std::string result = status == 0 ? text : symbol;
  const std::unique_ptr<char, decltype(&std::free)> owner(text, &std::free);
  return result;
}

}  // namespace tactree::wcet
