// libpng reads PNG files back unchanged. A failed write leaves no file.
#include <png.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "catch.h"

#include <pliant/io/format/png.h>
#include <pliant/io/format/whole_file.h>

namespace png_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

// A new folder, which is removed at the end of the test.
struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "pliant_png_XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()));
    path = name;
  }
  ~Folder() {
    ::chmod(path.c_str(), 0700);
    fs::remove_all(path);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(path), fs::directory_iterator());
  }
};

Image pattern(int width, int height) {
  Image image{width, height, {}};
  unsigned state = 12345;
  for (int i = 0; i < width * height * 3; ++i) {
    state = state * 1664525u + 1013904223u;
    image.rgb.push_back(static_cast<std::uint8_t>(i % 7 ? i / 5 : state >> 24));
  }
  return image;
}

Image read_back(const fs::path& path) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&png, path.c_str()));
  png.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  REQUIRE(png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr));
  return image;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("a picture is read back unchanged from a PNG file") {
  const Folder folder;
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(640, 480), std::pair(33, 7), std::pair(1, 300)}) {
    const Image image = pattern(width, height);
    write_png(image, folder.path / "a.png");
    const Image back = read_back(folder.path / "a.png");
    CHECK(back.width == width);
    CHECK(back.height == height);
    CHECK(back.rgb == image.rgb);
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("equal pictures give equal files") {
  const Folder folder;
  write_png(pattern(123, 45), folder.path / "a.png");
  write_png(pattern(123, 45), folder.path / "b.png");
  CHECK(bytes_of(folder.path / "a.png").size() > 100);
  CHECK(bytes_of(folder.path / "a.png") == bytes_of(folder.path / "b.png"));
}

TEST_CASE("a PNG file that cannot be written leaves no file, and the error names the path and the reason") {
  const Folder folder;
  const Image image = pattern(8, 8);
  const auto reason = [&](const fs::path& path) {
    try {
      write_png(image, path);
    } catch (const std::system_error& error) {
      const std::string text = error.what();
      CAPTURE(text);
      CHECK(text.find(path.string()) != std::string::npos);
      return error.code();
    }
    return std::error_code();
  };
  CHECK(reason(folder.path / "missing" / "a.png") == std::errc::no_such_file_or_directory);
  CHECK(folder.entries() == 0);

  fs::create_directory(folder.path / "taken.png");
  CHECK(reason(folder.path / "taken.png") == std::errc::is_a_directory);
  CHECK(folder.entries() == 1);

  write_whole_file(folder.path / "file", "x", 1);
  CHECK(reason(folder.path / "file" / "a.png") == std::errc::not_a_directory);
  CHECK(folder.entries() == 2);

  ::chmod(folder.path.c_str(), 0500);
  if (::access(folder.path.c_str(), W_OK) != 0) {
    CHECK(reason(folder.path / "a.png") == std::errc::permission_denied);
    CHECK(folder.entries() == 2);
  } else {
    WARN("write permission of folders is not enforced for this user");
  }
}

TEST_CASE("an image whose size does not match its number of bytes is refused") {
  const Folder folder;
  Image image = pattern(4, 4);
  image.rgb.pop_back();
  CHECK_THROWS_AS(write_png(image, folder.path / "a.png"), std::invalid_argument);
  CHECK_THROWS_AS(write_png({0, 0, {}}, folder.path / "a.png"), std::invalid_argument);
  CHECK_THROWS_AS(write_png({-1, -1, {0, 0, 0}}, folder.path / "a.png"), std::invalid_argument);
  CHECK(folder.entries() == 0);
}

TEST_CASE("a file is replaced as a whole") {
  const Folder folder;
  const fs::path path = folder.path / "data";
  write_whole_file(path, "long contents", 13);
  write_whole_file(path, "short", 5);
  CHECK(bytes_of(path) == "short");
  write_whole_file(path, nullptr, 0);
  CHECK(bytes_of(path).empty());
  CHECK(folder.entries() == 1);
}

}  // namespace png_test
