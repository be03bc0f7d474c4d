#include "runtime/host/descriptor_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/error.hpp"

namespace brace {

namespace {

Error broken(const std::string& place, const std::string& field, const std::string& expected,
             const std::string& found) {
  return device_error("{}: field '{}' is broken; expected {}; found {}", place, field, expected, found);
}

/// Copies what both sides know of a struct that starts with its size, and sets the size to `own_size`.
void copy_sized(void* to, std::size_t own_size, const void* from, std::size_t least_size,
                const std::string& place, const std::string& what) {
  std::uint32_t size = 0;
  std::memcpy(&size, from, sizeof size);
  if (size < least_size) {
    throw broken(place, what + ".struct_size", fmt::format("at least {}", least_size),
                 fmt::format("{}", size));
  }
  std::memset(to, 0, own_size);
  std::memcpy(to, from, std::min<std::size_t>(size, own_size));
  const auto own = static_cast<std::uint32_t>(own_size);
  std::memcpy(to, &own, sizeof own);
}

bool is_identifier(const char* text) {
  if (text == nullptr || text[0] < 'a' || text[0] > 'z') return false;
  return std::string_view(text).find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") ==
         std::string_view::npos;
}

std::string quoted(const char* text) {
  return text == nullptr ? std::string("null") : fmt::format("'{}'", text);
}

void require_text(const char* text, const std::string& place, const char* field) {
  if (text == nullptr || *text == '\0') throw broken(place, field, "a text", quoted(text));
}

void require_function(bool there, const std::string& place, const char* field) {
  if (!there) throw broken(place, field, "a function", "null");
}

void require_one(bool first, bool second, const std::string& place, const char* fields) {
  if (first == second) throw broken(place, fields, "exactly one function", first ? "both" : "null for both");
}

void check_param(const brace_param& param, const std::string& place) {
  if (!is_identifier(param.name))
    throw broken(place, "params.name", "snake_case (a-z, 0-9, _)", quoted(param.name));
  const std::string here = fmt::format("{}: parameter '{}'", place, param.name);
  if (param.type < BRACE_PARAM_BOOL || param.type > BRACE_PARAM_CHOICE) {
    throw broken(here, "type", "0 to 3", fmt::format("{}", static_cast<int>(param.type)));
  }
  if (param.type == BRACE_PARAM_CHOICE && (param.choices == nullptr || param.choices[0] == nullptr)) {
    throw broken(here, "choices", "at least one text, then null", "none");
  }
  if (param.type == BRACE_PARAM_BOOL || param.type == BRACE_PARAM_CHOICE) return;
  const bool ordered = std::isfinite(param.minimum) && std::isfinite(param.maximum) &&
                       param.minimum <= param.default_value && param.default_value <= param.maximum;
  if (!ordered) {
    throw broken(here, "default_value", "minimum <= default_value <= maximum",
                 fmt::format("{} in {} to {}", param.default_value, param.minimum, param.maximum));
  }
}

struct TableSize {
  std::size_t own, least;
};

TableSize table_size(std::uint32_t kind) {
  switch (kind) {
    case BRACE_KIND_RAYS:
      return {sizeof(brace_rays_functions), AbiSizes::rays};
    case BRACE_KIND_CAST:
      return {sizeof(brace_cast_functions), AbiSizes::cast};
    case BRACE_KIND_SKIP:
      return {sizeof(brace_skip_functions), AbiSizes::skip};
    case BRACE_KIND_STEREO:
      return {sizeof(brace_stereo_functions), AbiSizes::other};
    case BRACE_KIND_WARP:
      return {sizeof(brace_warp_functions), AbiSizes::other};
    case BRACE_KIND_CONTROL:
      return {sizeof(brace_control_functions), AbiSizes::other};
    case BRACE_KIND_PREDICT:
      return {sizeof(brace_predict_functions), AbiSizes::other};
    case BRACE_KIND_COST:
      return {sizeof(brace_cost_functions), AbiSizes::other};
    case BRACE_KIND_SCHEDULE:
      break;
  }
  return {0, 0};
}

template <typename Table>
const Table& table_of(const brace_stage_descriptor& stage) {
  return *static_cast<const Table*>(stage.functions);
}

void check_functions(const brace_stage_descriptor& stage, const std::string& place) {
  const auto require = [&](bool there, const char* field) { require_function(there, place, field); };
  switch (stage.kind) {
    case BRACE_KIND_RAYS:
      require(table_of<brace_rays_functions>(stage).open != nullptr, "functions.open");
      return require(table_of<brace_rays_functions>(stage).close != nullptr, "functions.close");
    case BRACE_KIND_CAST: {
      const auto& cast = table_of<brace_cast_functions>(stage);
      return require_one(cast.record != nullptr, cast.execute != nullptr, place, "functions.record, execute");
    }
    case BRACE_KIND_SKIP: {
      const auto& skip = table_of<brace_skip_functions>(stage);
      require(skip.block_edge_voxels != nullptr, "functions.block_edge_voxels");
      return require_one(skip.record_update != nullptr, skip.execute_update != nullptr, place,
                         "functions.record_update, execute_update");
    }
    case BRACE_KIND_STEREO:
      return require(table_of<brace_stereo_functions>(stage).record != nullptr, "functions.record");
    case BRACE_KIND_WARP:
      return require(table_of<brace_warp_functions>(stage).record != nullptr, "functions.record");
    case BRACE_KIND_CONTROL:
      return require(table_of<brace_control_functions>(stage).update != nullptr, "functions.update");
    case BRACE_KIND_PREDICT:
      return require(table_of<brace_predict_functions>(stage).predict != nullptr, "functions.predict");
    case BRACE_KIND_COST:
      return require(table_of<brace_cost_functions>(stage).cost != nullptr, "functions.cost");
    case BRACE_KIND_SCHEDULE:
      break;
  }
}

}  // namespace

brace_stage_descriptor own_descriptor(const brace_stage_descriptor* from, const std::string& place) {
  if (from == nullptr) throw broken(place, "stages", "a descriptor", "null");
  brace_stage_descriptor own{};
  copy_sized(&own, sizeof own, from, AbiSizes::descriptor, place, "descriptor");
  return own;
}

std::vector<brace_param> own_params(const brace_stage_descriptor& descriptor, const std::string& place) {
  if (descriptor.param_count > 64) {
    throw broken(place, "param_count", "at most 64", fmt::format("{}", descriptor.param_count));
  }
  std::vector<brace_param> params(descriptor.param_count);
  if (params.empty()) return params;
  if (descriptor.params == nullptr) throw broken(place, "params", "an array", "null");
  // The library's structs may be longer than ours: the first one's size is the distance between them.
  const auto* bytes = reinterpret_cast<const std::byte*>(descriptor.params);
  const std::size_t stride = descriptor.params->struct_size;
  for (std::size_t i = 0; i < params.size(); ++i) {
    copy_sized(&params[i], sizeof params[i], bytes + i * stride, AbiSizes::param, place,
               fmt::format("params[{}]", i));
  }
  return params;
}

std::vector<std::byte> own_functions(const brace_stage_descriptor& descriptor, const std::string& place) {
  const TableSize size = table_size(descriptor.kind);
  if (size.own == 0) return {};
  if (descriptor.functions == nullptr)
    throw broken(place, "functions", "the kind's table of functions", "null");
  std::vector<std::byte> table(size.own);
  copy_sized(table.data(), size.own, descriptor.functions, size.least, place, "functions");
  return table;
}

void check_descriptor(const brace_stage_descriptor& stage, const std::string& place) {
  if (stage.kind == BRACE_KIND_SCHEDULE) {
    throw broken(place, "kind", "a kind that libraries can provide",
                 "schedule, which is compiled into the host");
  }
  if (stage.kind < BRACE_KIND_RAYS || stage.kind > BRACE_KIND_COST) {
    throw broken(
        place, "kind",
        fmt::format("{} to {}", static_cast<int>(BRACE_KIND_RAYS), static_cast<int>(BRACE_KIND_COST)),
        fmt::format("{}", static_cast<int>(stage.kind)));
  }
  if (!is_identifier(stage.name)) throw broken(place, "name", "snake_case (a-z, 0-9, _)", quoted(stage.name));
  require_text(stage.version, place, "version");
  require_text(stage.help, place, "help");
  require_function(stage.create != nullptr, place, "create");
  require_function(stage.destroy != nullptr, place, "destroy");
  if ((stage.activate == nullptr) != (stage.deactivate == nullptr)) {
    throw broken(place, "activate, deactivate", "both or none", "one of them");
  }
  check_functions(stage, place);
  for (std::uint32_t i = 0; i < stage.param_count; ++i) {
    check_param(stage.params[i], place);
    for (std::uint32_t k = 0; k < i; ++k) {
      if (std::strcmp(stage.params[i].name, stage.params[k].name) == 0) {
        throw broken(place, "params.name", "a name of its own",
                     fmt::format("'{}' twice", stage.params[i].name));
      }
    }
  }
}

}  // namespace brace
