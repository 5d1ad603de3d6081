// Checksums of tables, and checkpoints.
// I55 in the name of a test is a row of the table in tests/README.md.
#include <pliant/io/checksums.h>

#include "catch.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/io/recording.h>
#include <pliant/io/run/checkpoint.h>
#include <pliant/io/run/run_files.h>
#include <pliant/simulate/simulation.h>

namespace checksums_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

void flip_bit(const fs::path& file, std::size_t byte) {
  std::string bytes = bytes_of(file);
  bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ 4);
  set_bytes(file, bytes);
}

}  // namespace

TEST_CASE("CRC-32 has its published check value, also in pieces") {
  CHECK(crc32_after(0, "123456789", 9) == 0xCBF43926u);
  CHECK(crc32_after(crc32_after(0, "1234", 4), "56789", 5) == 0xCBF43926u);
  CHECK(crc32_text(0xCBF43926u) == "cbf43926");
  CHECK(crc32_text(1) == "00000001");
}

TEST_CASE("I55: checksums name the first damaged row of a table, or of the checksums themselves") {
  const NewFolder folder;
  const std::vector<CheckedTable> tables{{"a.npy", true}, {"b.npy", false}};
  {
    NpyWriter a = NpyWriter::create(folder / "a.npy", 3), b = NpyWriter::create(folder / "b.npy", 2);
    ChecksumWriter sums = ChecksumWriter::create(folder / "sums.npy", tables);
    for (int state = 0; state < 10; ++state) {
      const double row[3] = {1.0 * state, 2, 3}, pair[2] = {0.5 * state, -1};
      a.append(row);
      sums.add(0, row, 3);
      for (int i = 0; i < state % 4; ++i) {
        b.append(pair);
        sums.add(1, pair, 2);
      }
      sums.end_state();
    }
    a.flush();
    b.flush();
    sums.flush();
  }
  const ChecksumReader reader(folder.path, "sums.npy", tables);
  CHECK(reader.states() == 10);
  CHECK(reader.whole_states() == 10);
  CHECK(reader.rows(1, 10) == 13);
  CHECK(reader.inspect().damage.empty());
  CHECK(reader.inspect().undamaged == 10);
  CHECK(crc32_text(reader.checksums(10)[0].second) ==
        crc32_text(crc32_after(0, bytes_of(folder / "a.npy").data() + 128, 10 * 3 * 8)));

  const std::string a = bytes_of(folder / "a.npy"), b = bytes_of(folder / "b.npy"),
                    sums = bytes_of(folder / "sums.npy");
  flip_bit(folder / "a.npy", 128 + 6 * 24 + 3);
  flip_bit(folder / "b.npy", 128 + 10 * 16);  // row 10 is one of the rows 9 to 11 of state 7
  const std::vector<std::string> damage = reader.inspect().damage;
  CHECK(reader.inspect().undamaged == 6);
  REQUIRE(damage.size() == 2);
  CHECK(damage[0].find("a.npy is damaged at row 6: its checksum does not match") != std::string::npos);
  CHECK(damage[1].find("b.npy is damaged at row 9, or between this row and row 12: its") !=
        std::string::npos);
  set_bytes(folder / "a.npy", a);
  set_bytes(folder / "b.npy", b);
  flip_bit(folder / "sums.npy", 128 + 4 * 32 + 8);
  CHECK(reader.inspect().undamaged == 4);
  REQUIRE(reader.inspect().damage.size() == 1);
  CHECK(reader.inspect().damage[0].find("sums.npy is damaged at row 4") != std::string::npos);
  set_bytes(folder / "sums.npy", sums);

  fs::resize_file(folder / "b.npy", b.size() - 20);  // the last whole row is row 10, of state 7
  CHECK(reader.whole_states() == 7);
  CHECK(reader.inspect().damage.empty());
  CHECK(reader.inspect().undamaged == 7);
  CHECK_THROWS_AS(ChecksumReader(folder.path, "sums.npy", {{"a.npy", true}}), RecordingMismatch);
}

TEST_CASE("the newest undamaged checkpoint with the given state count that is not after the end is found") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  Simulation simulation(scene->body, "rk4");
  const Model& model = simulation.model();
  std::vector<State> states;
  for (int i = 0; i < 3; ++i) {
    simulation.step(1e-3);
    states.push_back(simulation.state());
    RunWork work;
    work.steps.steps = i + 1;
    work.parts.mass_matrices = 4 * (i + 1);
    write_checkpoint(folder.path, {7, simulation.state(), work});
  }
  auto found_time = [&](std::int64_t rows, double end) {
    const FoundCheckpoint found = find_checkpoint(folder.path, model, rows, end);
    if (!found.checkpoint) return -1.0;
    const State& state = found.checkpoint->state;
    CHECK(found.checkpoint->work.steps.steps == state.step);
    CHECK(found.checkpoint->work.parts.mass_matrices == 4 * state.step);
    for (const State& known : states)
      if (known.time() == state.time()) CHECK(hash(known) == hash(state));
    return state.time();
  };
  CHECK(found_time(7, 1) == states[2].time());
  CHECK(found_time(6, 1) == -1);
  CHECK(found_time(7, 2.5e-3) == states[1].time());
  CHECK(found_time(7, 1e-4) == -1);
  // The third checkpoint has replaced the first checkpoint, in the first file.
  flip_bit(folder / kCheckpointFiles[0], 128 + 60);
  CHECK(found_time(7, 1) == states[1].time());
  CHECK(find_checkpoint(folder.path, model, 7, 1).damage.find("checkpoint_1.npy is damaged") !=
        std::string::npos);
  write_checkpoint(folder.path, {7, states[0], {}});  // replaces the damaged checkpoint
  CHECK(find_checkpoint(folder.path, model, 7, 1).damage.empty());
  CHECK(found_time(7, 1) == states[1].time());
  remove_checkpoints(folder.path);
  CHECK(found_time(7, 1) == -1);
}

}  // namespace checksums_test
