// libFuzzer target: any bytes are a table of doubles, and all rows of the table can be read, or the bytes are
// refused with std::runtime_error.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/io/format/npy.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_npy_" + std::to_string(::getpid()) + ".npy");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0) std::abort();
  try {
    const pliant::NpyReader table(path);
    const std::size_t columns =
        table.columns() == pliant::kNpyVector ? 1 : static_cast<std::size_t>(table.columns());
    if (columns == 0) return 0;
    // The file must be large enough for all rows.
    if (static_cast<std::size_t>(table.rows()) > size / (columns * sizeof(double))) std::abort();
    std::vector<double> row(columns);
    for (std::int64_t k = 0; k < table.rows(); ++k) table.read(k, row.data());
  } catch (const std::runtime_error&) {
    return 0;
  }
  return 0;
}
