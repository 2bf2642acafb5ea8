// The JSON schema of device files.

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "device_fields.hpp"
#include "tactree/support/blob_facts.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/json_text.hpp"

namespace tactree::support {
namespace {

using Schema = nlohmann::ordered_json;

Schema schema_of(const DeviceText& text) {
  Schema schema{{"description", text.about}, {"type", "string"}};
  if (!text.choices.empty()) {
    schema["enum"] = std::vector<std::string>(text.choices.begin(), text.choices.end());
  }
  if (text.fallback != nullptr) {
    schema["default"] = text.fallback;
  }
  return schema;
}

Schema number_schema(const DeviceField& field, bool in_use) {
  const double low = shortest_double(field.low);
  const double high = shortest_double(field.high);
  if (!in_use || field.magnitude_min == 0.0F) {
    return {{"type", "number"}, {"minimum", low}, {"maximum", high}};
  }
  const double least = shortest_double(field.magnitude_min);
  return {{"type", "number"},
          {"anyOf", Schema::array({{{"minimum", low}, {"maximum", -least}},
                                   {{"minimum", least}, {"maximum", high}}})}};
}

Schema schema_of(const DeviceField& field, core::DeviceKind kind) {
  Schema schema{{"description", field.about}};
  if (!field.per_axis()) {
    schema.update(number_schema(field, true));
    if (field.fallback) {
      schema["default"] = shortest_double(*field.fallback);
    }
    return schema;
  }
  Schema items = Schema::array();
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    items.push_back(number_schema(field, i < core::axes_of(kind)));
  }
  schema["type"] = "array";
  schema["items"] = items.front() == items.back() ? items.front() : items;
  schema["minItems"] = core::kAxes;
  schema["maxItems"] = core::kAxes;
  if (field.fallback) {
    const double value = shortest_double(*field.fallback);
    schema["default"] = {value, value, value};
  }
  return schema;
}

/// Adds the keys that every kind has.
void add_texts(Schema& required, Schema& properties) {
  for (const DeviceText& text : device_texts()) {
    properties[text.key] = schema_of(text);
    if (text.required) {
      required.push_back(text.key);
    }
  }
}

/// All keys of a device of this kind.
Schema schema_of(core::DeviceKind kind) {
  Schema required = Schema::array();
  Schema properties = Schema::object();
  add_texts(required, properties);
  for (const DeviceField& field : device_fields()) {
    if (!field.belongs_to(kind)) {
      continue;
    }
    properties[field.key] = schema_of(field, kind);
    if (!field.fallback) {
      required.push_back(field.key);
    }
  }
  return {{"required", required}, {"properties", properties}, {"additionalProperties", false}};
}

}  // namespace

std::string device_schema() {
  Schema kinds = Schema::array();
  for (std::uint32_t i = 0; i < core::kDeviceKinds; ++i) {
    kinds.push_back({{"if",
                      {{"required", Schema::array({"kind"})},
                       {"properties", {{"kind", {{"const", kKindNames[i]}}}}}}},
                     {"then", schema_of(static_cast<core::DeviceKind>(i))}});
  }
  Schema required = Schema::array();
  Schema properties = Schema::object();
  add_texts(required, properties);
  const Schema schema{
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "Haptic device"},
      {"description",
       "A device file of Tactree. `tactree device check` also checks the relations between the "
       "values of an axis."},
      {"type", "object"},
      {"required", required},
      {"properties", properties},
      {"allOf", kinds}};
  return json_text(schema);
}

}  // namespace tactree::support
