#include <pliant/io/run/run_record.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <system_error>

#include <nlohmann/json.hpp>

#include <pliant/io/format/whole_file.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/run_files.h>
#include <pliant/scene/json/text_file.h>

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "pliant run";
constexpr std::array<const char*, 4> kStatus{"running", "complete", "stopped", "failed"};

// Returns a bound as JSON; an infinite bound becomes null, because JSON has no infinity.
Json bound(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

// Returns the message "[json.exception.parse_error.101] parse error ..." without the tag in brackets.
std::string without_tag(const std::string& message) {
  const std::size_t end = message.find("] ");
  return end == std::string::npos ? message : message.substr(end + 2);
}

std::string hex(std::uint64_t hash) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

template <class Value>
Json pairs(const std::vector<std::pair<std::string, Value>>& list) {
  Json object = Json::object();
  for (const auto& [name, value] : list) object[name] = value;
  return object;
}

template <class Value>
std::vector<std::pair<std::string, Value>> read_pairs(const Json& object) {
  std::vector<std::pair<std::string, Value>> list;
  for (const auto& [name, value] : object.items()) list.emplace_back(name, value.template get<Value>());
  return list;
}

}  // namespace

void RunRecord::add_seconds(const std::string& stage, double amount) {
  for (auto& [name, sum] : seconds)
    if (name == stage) {
      sum += amount;
      return;
    }
  seconds.emplace_back(stage, amount);
}

void RunRecord::add_file(const std::string& name) {
  if (std::find(files.begin(), files.end(), name) == files.end()) files.push_back(name);
}

void RunRecord::set_checksum(const std::string& name, std::uint32_t checksum) {
  for (auto& [file, known] : checksums)
    if (file == name) {
      known = checksum;
      return;
    }
  checksums.emplace_back(name, checksum);
}

std::string RunRecord::trajectory_hash() const {
  std::string hash;
  for (const char* table : {kCoordinatesFile, kVelocitiesFile})
    for (const auto& [file, checksum] : checksums)
      if (file == table) hash += crc32_text(checksum);
  return hash;
}

namespace {

std::string dump(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// Returns the checksum of run.json, which covers its text without the checksum itself.
std::string check_of(const Json& json) {
  Json others = json;
  others.erase("check");
  const std::string text = dump(others);
  return crc32_text(crc32_after(0, text.data(), text.size()));
}

Json json_of(const Checksums& checksums) {
  Json object = Json::object();
  for (const auto& [file, checksum] : checksums) object[file] = crc32_text(checksum);
  return object;
}

Json options_of(const RunRecord& r) {
  return {{"end", r.end},
          {"asked_step", r.requested_step},
          {"step", r.step},
          {"tolerance", r.tolerance},
          {"frame_rate", r.frame_rate},
          {"integrator", r.integrator},
          {"asked_integrator", r.requested_integrator},
          {"joint_solver", r.joint_solver},
          {"threads", r.threads},
          {"width", r.width},
          {"height", r.height},
          {"graphics", r.graphics},
          {"command", r.command}};
}

Json violation_of(const ContactViolation& violation) {
  return {{"value", violation.value}, {"tolerance", violation.tolerance}, {"time", violation.time}};
}

Json monitors_of(const RunRecord& r) {
  return {{"max_balance_error", r.max_balance_error},
          {"balance_share", r.energy_share},
          {"movable_energy", r.movable_energy},
          {"max_energy", r.max_energy},
          {"max_kinetic", r.max_kinetic},
          {"max_gap", r.max_gap},
          {"open_gap", r.open_gap},
          {"max_depth", r.max_depth},
          {"asleep", r.asleep},
          {"max_contact_residual", r.work.steps.contact_residual},
          {"max_contact_overlap", r.work.steps.contact_overlap},
          {"worst_contact_residual", violation_of(r.work.steps.worst_residual)},
          {"worst_contact_overlap", violation_of(r.work.steps.worst_overlap)},
          {"largest_stable_step", bound(r.stable_step)}};
}

Json error_estimate_of(const ErrorEstimate& e) {
  return {{"place", e.place},
          {"rotation", e.rotation},
          {"length", e.length},
          {"parameter", e.parameter},
          {"displacement", e.displacement},
          {"velocity", e.velocity},
          {"angular_velocity", e.angular_velocity},
          {"energy", e.energy},
          {"joint_force", e.joint_force},
          {"joint_torque", e.joint_torque},
          {"gap", e.gap},
          {"tolerance", e.tolerance},
          {"step", e.step}};
}

}  // namespace

void write_run_record(const std::filesystem::path& file, const RunRecord& r) {
  Json json;
  json["format"] = kFormat;
  json["version"] = kRecordingVersion;
  json["status"] = kStatus[static_cast<std::size_t>(r.status)];
  json["message"] = r.message;
  json["progress"] = {{"time", r.time},
                      {"steps", r.steps},
                      {"steps_done", r.steps_done},
                      {"states", r.states},
                      {"durable_states", r.durable_states},
                      {"resumed", r.resumed}};
  json["scene"] = {
      {"name", r.scene}, {"file", r.scene_file}, {"overrides", r.overrides}, {"hash", hex(r.scene_hash)}};
  json["options"] = options_of(r);
  json["build"] = pairs(r.build);
  json["wall_seconds"] = pairs(r.seconds);
  json["work"] = pairs(counts_of(r.work));
  json["monitors"] = monitors_of(r);
  if (r.error) json["error_estimate"] = error_estimate_of(*r.error);
  json["held"] = r.velocities_without_inertia;
  json["skipped"] = r.skipped;
  json["notes"] = r.notes;
  json["files"] = r.files;
  json["trajectory_hash"] = r.trajectory_hash();
  json["checksums"] = json_of(r.checksums);
  json["check"] = check_of(json);
  const std::string text = dump(json) + "\n";
  write_whole_file(file, text.data(), text.size(), Durable::yes);
}

namespace {

void read_progress(const Json& progress, RunRecord& r) {
  progress.at("time").get_to(r.time);
  progress.at("steps").get_to(r.steps);
  progress.at("steps_done").get_to(r.steps_done);
  progress.at("states").get_to(r.states);
  progress.at("durable_states").get_to(r.durable_states);
  progress.at("resumed").get_to(r.resumed);
}

void read_scene(const Json& scene, RunRecord& r) {
  scene.at("name").get_to(r.scene);
  scene.at("file").get_to(r.scene_file);
  scene.at("overrides").get_to(r.overrides);
  r.scene_hash = std::stoull(scene.at("hash").get<std::string>(), nullptr, 16);
}

// Keys that are read with value() may be absent; a default value then replaces them.
void read_options(const Json& options, RunRecord& r) {
  options.at("end").get_to(r.end);
  options.at("asked_step").get_to(r.requested_step);
  options.at("step").get_to(r.step);
  r.tolerance = options.value("tolerance", 0.0);
  options.at("frame_rate").get_to(r.frame_rate);
  options.at("integrator").get_to(r.integrator);
  r.requested_integrator = options.value("asked_integrator", r.integrator);
  options.at("joint_solver").get_to(r.joint_solver);
  options.at("threads").get_to(r.threads);
  options.at("width").get_to(r.width);
  options.at("height").get_to(r.height);
  options.at("graphics").get_to(r.graphics);
  options.at("command").get_to(r.command);
}

/// Reads a violation of the laws of contact; returns an empty violation if the record has none.
ContactViolation read_violation(const Json& monitors, const char* key) {
  if (!monitors.contains(key)) return {};
  const Json& violation = monitors.at(key);
  return {violation.at("value"), violation.at("tolerance"), violation.at("time")};
}

void read_work(const Json& work, RunRecord& r) {
  for (const auto& [name, count] : work.items()) set_count(r.work, name, count.get<long>());
}

void read_monitors(const Json& monitors, RunRecord& r) {
  monitors.at("max_balance_error").get_to(r.max_balance_error);
  monitors.at("max_energy").get_to(r.max_energy);
  monitors.at("max_kinetic").get_to(r.max_kinetic);
  r.energy_share = monitors.value("balance_share", 0.0);
  r.movable_energy = monitors.value("movable_energy", 0.0);
  monitors.at("max_gap").get_to(r.max_gap);
  monitors.at("open_gap").get_to(r.open_gap);
  r.max_depth = monitors.value("max_depth", 0.0);
  r.asleep = monitors.value("asleep", 0);
  r.work.steps.contact_residual = monitors.value("max_contact_residual", 0.0);
  r.work.steps.contact_overlap = monitors.value("max_contact_overlap", 0.0);
  r.work.steps.worst_residual = read_violation(monitors, "worst_contact_residual");
  r.work.steps.worst_overlap = read_violation(monitors, "worst_contact_overlap");
  if (!monitors.at("largest_stable_step").is_null()) monitors.at("largest_stable_step").get_to(r.stable_step);
}

void read_checksums(const Json& checksums, RunRecord& r) {
  for (const auto& [file, checksum] : checksums.items())
    r.set_checksum(file,
                   static_cast<std::uint32_t>(std::stoul(checksum.template get<std::string>(), nullptr, 16)));
}

/// Throws RecordingMismatch if a run record is damaged, or if its version is not the version that this
/// program reads. Records of older versions may have no checksum and no version.
void require_readable(const Json& json, const std::filesystem::path& file) {
  if (json.at("format") != kFormat) throw RecordingMismatch(file.string() + " is not the record of a run");
  if (json.contains("check") && json.at("check") != check_of(json))
    throw RecordingMismatch(file.string() + " is damaged: its checksum does not match");
  const bool has_version = json.contains("version");
  if (!has_version || json.at("version") != kRecordingVersion)
    throw RecordingMismatch(
        file.string() + (has_version ? " has version " + json.at("version").dump() : " has no version") +
        ", and this program reads version " + std::to_string(kRecordingVersion) +
        " only. Read the run with the program that wrote it (\"build\" in the file), or simulate again with "
        "--force");
  json.at("check");  // throws if there is none
}

}  // namespace

RunRecord read_run_record(const std::filesystem::path& file) {
  std::string text;
  try {
    text = read_whole_file(file);
  } catch (const std::system_error& fault) {
    if (fault.code() != std::errc::no_such_file_or_directory && fault.code() != std::errc::not_a_directory)
      throw;
    throw FileError(FileError::Reason::kMissing, std::string("there is no run: ") + fault.what());
  }
  try {
    const Json json = Json::parse(text);
    require_readable(json, file);
    RunRecord r;
    const std::string status = json.at("status");
    const auto found = std::find(kStatus.begin(), kStatus.end(), status);
    if (found == kStatus.end()) throw RecordingMismatch(file.string() + " has the unknown status " + status);
    r.status = static_cast<RunRecord::Status>(found - kStatus.begin());
    json.at("message").get_to(r.message);
    read_progress(json.at("progress"), r);
    read_scene(json.at("scene"), r);
    read_options(json.at("options"), r);
    r.build = read_pairs<std::string>(json.at("build"));
    r.seconds = read_pairs<double>(json.at("wall_seconds"));
    read_work(json.at("work"), r);
    read_monitors(json.at("monitors"), r);
    json.at("held").get_to(r.velocities_without_inertia);
    json.at("skipped").get_to(r.skipped);
    json.at("notes").get_to(r.notes);
    json.at("files").get_to(r.files);
    read_checksums(json.at("checksums"), r);
    return r;
  } catch (const nlohmann::json::exception& fault) {
    throw RecordingMismatch(file.string() + " is damaged: " + without_tag(fault.what()));
  } catch (const std::logic_error&) {
    throw RecordingMismatch(file.string() + " is damaged: a hash or checksum in it is not a number");
  }
}

}  // namespace pliant
