#include <algorithm>
#include <map>

#include <spirv/unified1/spirv.hpp11>

#include "base/error.hpp"
#include "runtime/gpu/pipeline.hpp"

namespace brace::gpu {
namespace {

// What a pass over the module collects; keys are SPIR-V ids.
struct Module {
  struct Type {
    spv::Op op = spv::Op::OpNop;
    std::vector<std::uint32_t> operands;  // after the result id
  };
  struct Variable {
    std::uint32_t id = 0, type = 0;
    spv::StorageClass storage = spv::StorageClass::Max;
  };
  std::map<std::uint32_t, Type> types;
  std::map<std::uint32_t, std::uint32_t> constants;  // integer constants, for array lengths
  std::map<std::uint32_t, std::string> names;
  std::map<std::uint32_t, std::uint32_t> slots, sets;
  std::map<std::uint32_t, bool> is_buffer_block;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> member_offsets;
  std::map<std::uint32_t, std::uint32_t> array_strides;
  std::vector<Variable> variables;
  std::array<std::uint32_t, 3> local_size{1, 1, 1};
  std::uint32_t work_group_size_id = 0;
  bool has_specialised_size = false;
};

std::string read_string(std::span<const std::uint32_t> words) {
  std::string text;
  for (const std::uint32_t word : words)
    for (unsigned shift = 0; shift < 32; shift += 8) {
      const auto c = static_cast<char>((word >> shift) & 0xff);
      if (c == '\0') return text;
      text += c;
    }
  return text;
}

void read_decoration(Module& module, std::span<const std::uint32_t> words) {
  const std::uint32_t target = words[0];
  switch (static_cast<spv::Decoration>(words[1])) {
    case spv::Decoration::Binding:
      module.slots[target] = words[2];
      break;
    case spv::Decoration::DescriptorSet:
      module.sets[target] = words[2];
      break;
    case spv::Decoration::BufferBlock:
      module.is_buffer_block[target] = true;
      break;
    case spv::Decoration::ArrayStride:
      module.array_strides[target] = words[2];
      break;
    case spv::Decoration::BuiltIn:
      if (static_cast<spv::BuiltIn>(words[2]) == spv::BuiltIn::WorkgroupSize)
        module.work_group_size_id = target;
      break;
    default:
      break;
  }
}

void read_instruction(Module& module, spv::Op op, std::span<const std::uint32_t> words) {
  switch (op) {
    case spv::Op::OpName:
      module.names[words[0]] = read_string(words.subspan(1));
      break;
    case spv::Op::OpDecorate:
      read_decoration(module, words);
      break;
    case spv::Op::OpMemberDecorate:
      if (static_cast<spv::Decoration>(words[2]) == spv::Decoration::Offset)
        module.member_offsets[{words[0], words[1]}] = words[3];
      break;
    case spv::Op::OpExecutionMode:
      if (static_cast<spv::ExecutionMode>(words[1]) == spv::ExecutionMode::LocalSize)
        module.local_size = {words[2], words[3], words[4]};
      break;
    case spv::Op::OpTypeInt:
    case spv::Op::OpTypeFloat:
    case spv::Op::OpTypeVector:
    case spv::Op::OpTypeMatrix:
    case spv::Op::OpTypeArray:
    case spv::Op::OpTypeRuntimeArray:
    case spv::Op::OpTypeStruct:
    case spv::Op::OpTypeImage:
    case spv::Op::OpTypeSampledImage:
    case spv::Op::OpTypePointer:
      module.types[words[0]] = {op, {words.begin() + 1, words.end()}};
      break;
    case spv::Op::OpConstant:
      module.constants[words[1]] = words[2];
      break;
    case spv::Op::OpSpecConstantComposite:
      if (words[1] == module.work_group_size_id) module.has_specialised_size = true;
      break;
    case spv::Op::OpVariable:
      module.variables.push_back({words[1], words[0], static_cast<spv::StorageClass>(words[2])});
      break;
    default:
      break;
  }
}

Module read_module(std::span<const std::uint32_t> spirv, const std::string& name) {
  if (spirv.size() < 5 || spirv[0] != spv::MagicNumber) throw device_error("kernel {}: not SPIR-V", name);
  Module module;
  for (std::size_t at = 5; at < spirv.size();) {
    const std::size_t words = spirv[at] >> 16;
    if (words == 0 || words > spirv.size() - at) throw device_error("kernel {}: damaged SPIR-V", name);
    read_instruction(module, static_cast<spv::Op>(spirv[at] & 0xffff), spirv.subspan(at + 1, words - 1));
    at += words;
  }
  return module;
}

// Bytes of a type of a push constant block; the offsets and strides in the module decide the layout.
std::uint32_t type_bytes(const Module& module, std::uint32_t id) {
  const Module::Type& type = module.types.at(id);
  const std::vector<std::uint32_t>& operands = type.operands;
  switch (type.op) {
    case spv::Op::OpTypeInt:
    case spv::Op::OpTypeFloat:
      return operands[0] / 8;
    case spv::Op::OpTypeVector:
    case spv::Op::OpTypeMatrix:
      return type_bytes(module, operands[0]) * operands[1];
    case spv::Op::OpTypeArray:
      return module.array_strides.at(id) * module.constants.at(operands[1]);
    case spv::Op::OpTypeStruct: {
      std::uint32_t end = 0;
      for (std::uint32_t member = 0; member < operands.size(); ++member)
        end = std::max(end, module.member_offsets.at({id, member}) + type_bytes(module, operands[member]));
      return (end + 3) & ~3u;
    }
    default:
      return 0;
  }
}

BindingKind kind_of(const Module& module, const Module::Variable& variable, std::uint32_t type_id,
                    const std::string& name) {
  const Module::Type& type = module.types.at(type_id);
  if (type.op == spv::Op::OpTypeStruct) {
    const bool is_storage =
        variable.storage == spv::StorageClass::StorageBuffer || module.is_buffer_block.contains(type_id);
    return is_storage ? BindingKind::storage_buffer : BindingKind::uniform_buffer;
  }
  const bool combined = type.op == spv::Op::OpTypeSampledImage;
  const Module::Type& image = combined ? module.types.at(type.operands[0]) : type;
  if (image.op == spv::Op::OpTypeImage) {
    const bool is_buffer = static_cast<spv::Dim>(image.operands[1]) == spv::Dim::Buffer;
    const bool is_storage = image.operands[5] == 2;
    if (is_buffer) return is_storage ? BindingKind::storage_texel_buffer : BindingKind::uniform_texel_buffer;
    if (is_storage) return BindingKind::storage_image;
    if (combined) return BindingKind::sampled_image;
  }
  throw device_error("kernel {}: '{}' is neither a buffer, a texel buffer, an image nor a combined sampler",
                     name, module.names.contains(variable.id) ? module.names.at(variable.id) : "a binding");
}

std::string name_of(const Module& module, std::uint32_t variable, std::uint32_t type) {
  for (const std::uint32_t id : {variable, type})
    if (const auto found = module.names.find(id); found != module.names.end() && !found->second.empty())
      return found->second;
  return "unnamed";
}

}  // namespace

const char* to_string(BindingKind kind) {
  switch (kind) {
    case BindingKind::storage_buffer:
      return "storage buffer";
    case BindingKind::uniform_buffer:
      return "uniform buffer";
    case BindingKind::uniform_texel_buffer:
      return "uniform texel buffer";
    case BindingKind::storage_texel_buffer:
      return "storage texel buffer";
    case BindingKind::sampled_image:
      return "sampled image";
    case BindingKind::storage_image:
      return "storage image";
  }
  return "resource";
}

KernelInterface reflect(std::span<const std::uint32_t> spirv, const std::string& name) {
  const Module module = read_module(spirv, name);
  // Work-group counts would need the specialised values; a define does the same.
  if (module.has_specialised_size)
    throw device_error("kernel {}: the work-group size is a specialisation constant; use a define", name);
  KernelInterface interface;
  interface.local_size = module.local_size;
  for (const Module::Variable& variable : module.variables) {
    const std::uint32_t pointee = module.types.at(variable.type).operands[1];
    if (variable.storage == spv::StorageClass::PushConstant)
      interface.push_constant_bytes = type_bytes(module, pointee);
    const auto slot = module.slots.find(variable.id);
    if (slot == module.slots.end()) continue;
    if (const auto set = module.sets.find(variable.id); set != module.sets.end() && set->second != 0)
      throw device_error("kernel {}: '{}' is in descriptor set {}; only set 0 is used", name,
                         name_of(module, variable.id, pointee), set->second);
    interface.bindings.push_back(
        {slot->second, kind_of(module, variable, pointee, name), name_of(module, variable.id, pointee)});
  }
  std::sort(interface.bindings.begin(), interface.bindings.end(),
            [](const auto& a, const auto& b) { return a.slot < b.slot; });
  for (std::size_t i = 1; i < interface.bindings.size(); ++i)
    if (interface.bindings[i].slot == interface.bindings[i - 1].slot)
      throw device_error("kernel {}: '{}' and '{}' share slot {}", name, interface.bindings[i - 1].name,
                         interface.bindings[i].name, interface.bindings[i].slot);
  return interface;
}

}  // namespace brace::gpu
