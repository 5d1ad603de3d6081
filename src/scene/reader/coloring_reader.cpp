#include "coloring_reader.h"

#include <cmath>

namespace pliant {

schema::Record coloring_record() {
  using namespace schema;
  std::vector<Choice> quantities;
  for (const QuantityInfo& info : all_quantities()) quantities.push_back({info.name, info.meaning});
  const Type range = array(number(unbounded(), "m or 1"), 2, 2)
                         .checked([](const JsonValue& value, const ReportAt& report) {
                           const JsonValue::Array& ends = value.array();
                           const double span = ends[1].number() - ends[0].number();
                           if (!(span > 0) || !std::isfinite(span))
                             report(value, "expected [from, to] with from < to", kWholeValue);
                         })
                         .expecting("[from, to], two numbers (m or 1)");
  return {
      "coloring",
      "Colours of parts by their deformation, with a colour bar. When absent, parts have their own colours.",
      {required("by", choice(std::move(quantities)), "The quantity that the colours show.", "\"strain\""),
       optional(
           "range", range,
           "Values of the first and the last colour. When absent, from 0 to a round number above the "
           "99th percentile of the values at all vertices, in the recorded state in which this percentile is "
           "largest."),
       optional("parts", array(name(), 1), "Names of the parts; when absent, all parts that deform.")}};
}

Coloring read_coloring(const Reader& coloring, const std::map<std::string, NamedPart>& parts,
                       SceneFaults& faults) {
  Coloring result;
  result.by = *find_quantity(coloring.text("by"));
  if (coloring.given("range")) {
    const std::vector<double> ends = coloring.numbers("range");
    result.range = {ends[0], ends[1]};
  }
  if (!coloring.given("parts")) return result;
  std::vector<std::string> names;
  for (const auto& [name, part] : parts) names.push_back(name);
  for (const JsonValue& name : coloring.at("parts").array()) {
    const auto named = parts.find(name.string());
    if (named == parts.end())
      faults.unknown(name, "part", names);
    else if (named->second.part != nullptr)
      result.parts.push_back(named->second.part);
  }
  return result;
}

}  // namespace pliant
