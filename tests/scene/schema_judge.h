// A validator for a JSON Schema. The library valijson, which is independent of pliant, validates.
#pragma once

#include <string>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace pliant::test {

class SchemaValidator {
 public:
  explicit SchemaValidator(const std::string& schema) : text_(nlohmann::json::parse(schema)) {
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(valijson::adapters::NlohmannJsonAdapter(text_), schema_);
  }

  bool accepts(const nlohmann::json& value) const {
    return valijson::Validator().validate(schema_, valijson::adapters::NlohmannJsonAdapter(value), nullptr);
  }

 private:
  nlohmann::json text_;
  valijson::Schema schema_;
};

}  // namespace pliant::test
