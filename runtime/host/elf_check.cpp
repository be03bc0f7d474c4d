#include <array>
#include <bit>
#include <cstring>
#include <fstream>

#include <elf.h>

#include "base/error.hpp"
#include "runtime/host/plugin_library.hpp"

namespace brace {

namespace {

#if defined(__x86_64__)
constexpr std::uint16_t kOwnMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr std::uint16_t kOwnMachine = EM_AARCH64;
#elif defined(__riscv)
constexpr std::uint16_t kOwnMachine = EM_RISCV;
#else
constexpr std::uint16_t kOwnMachine = EM_NONE;  // not known by name: left to the dynamic linker
#endif

std::string machine_name(std::uint16_t machine) {
  switch (machine) {
    case EM_386:
      return "32-bit x86";
    case EM_X86_64:
      return "x86-64";
    case EM_ARM:
      return "32-bit ARM";
    case EM_AARCH64:
      return "AArch64";
    case EM_RISCV:
      return "RISC-V";
    case EM_PPC64:
      return "PowerPC 64";
    case EM_S390:
      return "S/390";
    default:
      return fmt::format("machine {}", machine);
  }
}

std::string type_name(std::uint16_t type) {
  switch (type) {
    case ET_REL:
      return "an object file (not linked yet)";
    case ET_EXEC:
      return "a program";
    case ET_CORE:
      return "a core dump";
    default:
      return fmt::format("ELF type {}", type);
  }
}

Error not_a_library(const std::filesystem::path& file, const std::string& expected,
                    const std::string& found) {
  return device_error("{}: cannot be loaded as a plug-in; expected {}; found {}", file.string(), expected,
                      found);
}

/// A file cut short maps beyond its end and takes the program down when it is touched.
void check_segments(const std::filesystem::path& file, std::ifstream& stream, const Elf64_Ehdr& header,
                    std::uint64_t file_bytes) {
  for (std::uint16_t i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment{};
    stream.seekg(static_cast<std::streamoff>(header.e_phoff + std::uint64_t{i} * sizeof segment));
    stream.read(reinterpret_cast<char*>(&segment), sizeof segment);
    const bool whole = stream.good() && segment.p_offset <= file_bytes &&
                       (segment.p_type != PT_LOAD || segment.p_filesz <= file_bytes - segment.p_offset);
    if (!whole)
      throw not_a_library(file, "a whole file", fmt::format("one cut short at {} bytes", file_bytes));
  }
}

}  // namespace

void check_shared_library(const std::filesystem::path& file) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) {
    throw input_error("{}: there is no such file; accepted: a shared library of stages", file.string());
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw input_error("{}: cannot be read", file.string());
  const std::uint64_t file_bytes = std::filesystem::file_size(file, failed);
  Elf64_Ehdr header{};
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  const auto got = static_cast<std::size_t>(stream.gcount());
  if (got < SELFMAG || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) {
    throw not_a_library(file, "a shared library (ELF)", got == 0 ? "an empty file" : "a file that is none");
  }
  if (got < sizeof header) {
    throw not_a_library(file, "a whole file", fmt::format("one cut short at {} bytes", file_bytes));
  }
  const bool little = header.e_ident[EI_DATA] == ELFDATA2LSB;
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || little != (std::endian::native == std::endian::little)) {
    throw not_a_library(
        file, fmt::format("a library for {}", machine_name(kOwnMachine)),
        fmt::format("{}-bit code, {} endian", header.e_ident[EI_CLASS] == ELFCLASS32 ? 32 : 64,
                    little ? "little" : "big"));
  }
  if (kOwnMachine != EM_NONE && header.e_machine != kOwnMachine) {
    throw not_a_library(file, fmt::format("a library for {}", machine_name(kOwnMachine)),
                        fmt::format("one for {}", machine_name(header.e_machine)));
  }
  if (header.e_type != ET_DYN) throw not_a_library(file, "a shared library", type_name(header.e_type));
  check_segments(file, stream, header, file_bytes);
}

}  // namespace brace
