#include "color_reader.h"

#include <string>

namespace pliant {

Color read_color(const JsonValue& value) {
  if (value.is_array())
    return {value.array()[0].number(), value.array()[1].number(), value.array()[2].number()};
  Color c;
  for (std::size_t i = 0; i < 3; ++i)
    c[i] = std::stoi(value.string().substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
  return c;
}

}  // namespace pliant
