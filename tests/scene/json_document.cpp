// JSON documents: positions of values, messages about syntax errors, refused documents, the option --set.
// tests/README.md explains the numbers I01, I02, ... in test names (stress catalogue).
#include <pliant/scene/json/json_document.h>

#include <sys/stat.h>
#include <unistd.h>

#include <clocale>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "catch.h"

namespace json_document_test {

using pliant::Diagnostics;
using pliant::FileError;
using pliant::JsonDocument;
using pliant::JsonValue;
using pliant::SceneError;

namespace {

namespace fs = std::filesystem;

/// Returns the messages about a text; empty if the text is valid.
std::string faults(const std::string& text) {
  Diagnostics diagnostics;
  try {
    JsonDocument::parse("s.json", text, diagnostics);
  } catch (const SceneError& e) {
    return e.what();
  }
  return diagnostics.text();
}

/// Returns the document with this text, which must be valid.
JsonDocument sound(const std::string& text) {
  Diagnostics diagnostics;
  JsonDocument document = JsonDocument::parse("s.json", text, diagnostics);
  REQUIRE(diagnostics.text().empty());
  return document;
}

/// Returns "line:column" of the value at a JSON pointer.
std::string place(const JsonDocument& document, const std::string& pointer) {
  const JsonValue* value = document.at(pointer);
  REQUIRE(value != nullptr);
  const auto d = document.fault(*value, "");
  CHECK(d.pointer == pointer);
  return std::to_string(d.line) + ":" + std::to_string(d.column);
}

/// Returns the messages about an argument of --set for a document with this text.
std::string set_faults(const std::string& text, const std::string& assignment) {
  JsonDocument document = sound(text);
  Diagnostics diagnostics;
  document.set(assignment, diagnostics);
  return diagnostics.text();
}

/// A temporary folder. The destructor removes the folder.
struct Folder {
  Folder() : path(fs::temp_directory_path() / ("pliant_json_" + std::to_string(::getpid()))) {
    fs::create_directory(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return (path / name).string();
  }
  fs::path path;
};

/// Returns the message of the FileError for a path, and checks its exit code; "no fault" if the file is read.
std::string read_fault(const std::string& path, int exit_code) {
  Diagnostics diagnostics;
  try {
    JsonDocument::read(path, diagnostics);
  } catch (const FileError& e) {
    CHECK(e.exit_code() == exit_code);
    return e.what();
  }
  return "no fault";
}

}  // namespace

TEST_CASE("values keep type, order and position") {
  const JsonDocument d = sound(R"({
  "name": "arm", "//": "one", "//": "two",
  "n": [1, -2.5, 3.0, 1e3, true, false, null],
  "empty": {}, "none": [ ],
  "deep": {"a": [{"b": "\u00e9\n"}]}
}
)");
  const JsonValue& root = d.root();
  REQUIRE(root.is_object());
  CHECK(root.members().size() == 7);
  CHECK(root.members()[0].key == "name");
  CHECK(root.members()[2].value.string() == "two");
  const JsonValue::Array& n = root.find("n")->array();
  CHECK(n[0].number() == 1);
  CHECK(n[0].is_integer_literal());
  CHECK(n[1].number() == -2.5);
  CHECK_FALSE(n[2].is_integer_literal());
  CHECK(n[3].number() == 1000);
  CHECK_FALSE(n[3].is_integer_literal());
  CHECK(n[4].boolean());
  CHECK_FALSE(n[5].boolean());
  CHECK(n[6].is_null());
  CHECK(d.at("/deep/a/0/b")->string() == "\xC3\xA9\n");
  CHECK(d.at("/deep/a/1") == nullptr);
  CHECK(d.at("/deep/a/00") == nullptr);
  CHECK(d.at("deep") == nullptr);
  CHECK(d.at("") == &root);

  CHECK(place(d, "") == "1:1");
  CHECK(place(d, "/name") == "2:11");
  CHECK(place(d, "/n") == "3:8");
  CHECK(place(d, "/n/0") == "3:9");
  CHECK(place(d, "/n/1") == "3:12");
  CHECK(place(d, "/n/4") == "3:28");
  CHECK(place(d, "/n/6") == "3:41");
  CHECK(place(d, "/empty") == "4:12");
  CHECK(place(d, "/none") == "4:24");
  CHECK(place(d, "/deep/a/0/b") == "5:24");
  const auto key = d.fault_at_key(root, "empty", "x");
  CHECK((key.line == 4 && key.column == 3 && key.pointer == "/empty"));
  CHECK(d.shown(n[1]) == "-2.5");
  CHECK(d.shown(*root.find("n")) == "[1, -2.5, 3.0, 1e3, true, false, null]");
  CHECK(d.shown(root) == "an object with \"name\", \"n\", \"empty\", \"none\", \"deep\"");
  CHECK(d.shown(*root.find("name")) == "\"arm\"");
}

TEST_CASE("pointers escape ~ and /") {
  const JsonDocument d = sound(R"({"a/b": {"c~d": 1}})");
  CHECK(d.at("/a~1b/c~0d")->number() == 1);
  CHECK(d.pointer_to(*d.at("/a~1b/c~0d")) == "/a~1b/c~0d");
  CHECK(d.at("/a~2b") == nullptr);
}

TEST_CASE("columns count characters, also inside strings with escapes") {
  const JsonDocument d =
      sound("{\"\xC3\xA4\xE2\x82\xAC\": \"\xF0\x9F\x98\x80\", \"f\": \"a\\n\\u00e9\\ud83d\\ude00b\"}");
  CHECK(place(d, "/\xC3\xA4\xE2\x82\xAC") == "1:8");
  CHECK(place(d, "/f") == "1:18");
  const JsonValue& f = *d.at("/f");
  CHECK(f.string() ==
        "a\n\xC3\xA9\xF0\x9F\x98\x80"
        "b");
  const auto column = [&](std::size_t byte) { return d.fault_in_string(f, byte, "").column; };
  CHECK(column(0) == 19);  // a
  CHECK(column(1) == 20);  // \n
  CHECK(column(2) == 22);  // \u00e9
  CHECK(column(3) == 22);  // the second byte of \u00e9
  CHECK(column(4) == 28);  // the surrogate pair
  CHECK(column(8) == 40);  // b
  CHECK(column(9) == 41);  // the closing quote
  CHECK(column(99) == 41);
}

TEST_CASE("I02 an empty file is reported as empty") {
  CHECK(faults("") == "s.json:1:1: error: empty; expected a JSON object\n");
  CHECK(faults(" \n\t ") == "s.json:1:1: error: empty; expected a JSON object\n");
  CHECK(faults("\xEF\xBB\xBF\n") == "s.json:1:1: error: empty; expected a JSON object\n");
}

TEST_CASE("I03 messages of syntax errors contain the correction") {
  CHECK(faults("{\"a\": [1, 2,]}") == "s.json:1:12: error: a comma before \"]\"; remove it\n");
  CHECK(faults("{\"a\": 1,\n}") == "s.json:1:8: error: a comma before \"}\"; remove it\n");
  CHECK(faults("{\"a\": [1, 2}") ==
        "s.json:1:12: error: \"}\" does not close \"[\" at line 1, column 7; expected \"]\" before it\n");
  CHECK(faults("{\n  \"a\": {\n    \"b\": 1\n") ==
        "s.json:4:1: error: the file ends, but \"{\" at line 2, column 8 is still open; expected \"}\"\n");
  CHECK(faults("{\"a\": [1, 2") ==
        "s.json:1:12: error: the file ends, but \"[\" at line 1, column 7 is still open; expected \"]\"\n");
  CHECK(faults("{\"a\"") ==
        "s.json:1:5: error: the file ends, but \"{\" at line 1, column 1 is still open; expected \"}\"\n");
  CHECK(faults("{\"a\": ") ==
        "s.json:1:7: error: the file ends, but \"{\" at line 1, column 1 is still open; expected \"}\"\n");
  CHECK(faults("{\"a\": 1 \"b\": 2}") == "s.json:1:9: error: \"b\"; expected \",\" before it or \"}\"\n");
  CHECK(faults("[1 2]") == "s.json:1:4: error: \"2\"; expected \",\" before it or \"]\"\n");
  CHECK(faults("{\"a\" 1}") == "s.json:1:6: error: \"1\"; expected \":\" after a key\n");
  CHECK(faults("{a: 1}") == "s.json:1:2: error: \"a\"; a key is written in double quotes\n");
  CHECK(faults("{'a': 1}") == "s.json:1:2: error: \"'a'\"; a key is written in double quotes\n");
  CHECK(faults("{1: 1}") == "s.json:1:2: error: \"1\"; expected a key in double quotes or \"}\"\n");
  CHECK(faults("{,}") == "s.json:1:2: error: \",\"; expected a key in double quotes or \"}\"\n");
  CHECK(faults("[,1]") == "s.json:1:2: error: \",\"; expected a value\n");
  CHECK(faults("[1,,2]") == "s.json:1:4: error: \",\"; expected a value\n");
  CHECK(faults("{\"a\":}") == "s.json:1:6: error: \"}\"; expected a value after \":\"\n");
  CHECK(faults("{\"a\": True}") == "s.json:1:7: error: \"True\"; expected a value; did you mean \"true\"?\n");
  CHECK(faults("{\"a\": None}") == "s.json:1:7: error: \"None\"; expected a value; did you mean \"null\"?\n");
  CHECK(faults("{\"a\": sphere}") ==
        "s.json:1:7: error: \"sphere\"; expected a value; text is written in double quotes\n");
  CHECK(faults("{\"a\": 'b'}") == "s.json:1:7: error: \"'b'\"; text is written in double quotes\n");
  CHECK(faults("}") == "s.json:1:1: error: \"}\"; expected a value\n");
  CHECK(faults("{\"a\": \"b}\n") ==
        "s.json:1:7: error: the text that begins here is not closed on its line; expected '\"' (a line break "
        "is \\n)\n");
  CHECK(faults("{\"a\": \"b}") ==
        "s.json:1:7: error: the text that begins here is not closed; expected '\"'\n");
}

TEST_CASE("I04 text after the document is refused") {
  CHECK(faults("{}\n{}") ==
        "s.json:2:1: error: \"{\" after the end of the document; a file contains one value\n");
  CHECK(faults("{} x") ==
        "s.json:1:4: error: \"x\" after the end of the document; a file contains one value\n");
  CHECK(faults("{}}") ==
        "s.json:1:3: error: \"}\" after the end of the document; a file contains one value\n");
}

TEST_CASE("I05 invalid numbers are refused") {
  for (const char* word :
       {"NaN", "nan", "Infinity", "-Infinity", "inf", "-inf", "1.#IND", "-1.#INF", "+inf"}) {
    CHECK(faults("{\"a\": " + std::string(word) + "}") ==
          "s.json:1:7: error: \"" + std::string(word) + "\"; not JSON; write a finite number\n");
  }
  CHECK(faults("[+1]") == "s.json:1:2: error: \"+1\"; a number has no leading \"+\"\n");
  CHECK(faults("[.5]") == "s.json:1:2: error: \".5\"; a number has digits before and after its point\n");
  CHECK(faults("[5.]") == "s.json:1:2: error: \"5.\"; a number has digits before and after its point\n");
  CHECK(faults("[-05]") == "s.json:1:2: error: \"-05\"; a number has no leading zero\n");
  CHECK(faults("[0x10]") == "s.json:1:2: error: \"0x10\"; a number has no leading zero\n");
  CHECK(faults("[1.5m]") ==
        "s.json:1:2: error: \"1.5m\"; expected a number without a unit; the unit of each key is fixed\n");
  CHECK(faults("[1e]") == "s.json:1:2: error: \"1e\"; expected a number\n");
  CHECK(faults("[-]") == "s.json:1:2: error: \"-\"; expected a number\n");
}

TEST_CASE("I06 numbers that are too large are refused") {
  const std::string tail = "\"; too large for a number; expected at most 1.797e308 in magnitude\n";
  CHECK(faults("{\"a\": 1e400}") == "s.json:1:7: error: \"1e400" + tail);
  CHECK(faults("{\"a\": [0, -1e400]}") == "s.json:1:11: error: \"-1e400" + tail);
  CHECK(faults("[" + std::string(400, '9') + "]") ==
        "s.json:1:2: error: \"" + std::string(30, '9') + "..." + tail);
  CHECK(sound("[1.7976931348623157e308]").root().array()[0].number() == 1.7976931348623157e308);
}

TEST_CASE("I07 numbers that would be rounded to zero are refused") {
  CHECK(
      faults("{\"a\": 1e-400, \"b\": [-1e-999]}") ==
      "s.json:1:7: error: /a: 1e-400; too small for a number, it would become 0; expected 0 or at least "
      "4.95e-324 in "
      "magnitude\n"
      "s.json:1:21: error: /b/0: -1e-999; too small for a number, it would become 0; expected 0 or at least "
      "4.95e-324 in magnitude\n");
  CHECK(sound("[0e-999, 5e-324, 0.0, -0.0]").root().array()[1].number() == 5e-324);
}

TEST_CASE("numbers do not depend on the locale") {
  const char* locale = std::setlocale(LC_ALL, "de_DE.UTF-8");
  CHECK(sound("[2.5]").root().array()[0].number() == 2.5);
  if (locale != nullptr) std::setlocale(LC_ALL, "C");
}

TEST_CASE("I11 duplicate keys are reported with both positions") {
  CHECK(faults("{\"a\": 1,\n \"b\": {\"c\": 1, \"c\": 2, \"c\": 3},\n \"a\": 2, \"//\": 1, \"//\": 2}") ==
        "s.json:2:16: error: /b/c: key given twice; the first is at line 2, column 8\n"
        "s.json:2:24: error: /b/c: key given twice; the first is at line 2, column 8\n"
        "s.json:3:2: error: /a: key given twice; the first is at line 1, column 2\n");
  CHECK(faults("[{}, {\"x/y\": 1, \"x\\/y\": 2}]") ==
        "s.json:1:17: error: /1/x~1y: key given twice; the first is at line 1, column 7\n");
}

TEST_CASE("I18 deep nesting is refused with its position") {
  CHECK(faults(std::string(64, '[') + std::string(64, ']')).empty());
  CHECK(faults(std::string(65, '[') + std::string(65, ']')) ==
        "s.json:1:65: error: nested deeper than 64 levels\n");
  CHECK(faults(std::string(100000, '[')) == "s.json:1:65: error: nested deeper than 64 levels\n");
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  CHECK(faults(objects) == "s.json:1:321: error: nested deeper than 64 levels\n");
}

TEST_CASE("I19 files that are too large and texts with too many values are refused") {
  const Folder folder;
  const std::string path = folder.write("large.json", "{}");
  fs::resize_file(path, (std::uintmax_t{64} << 20) + 1);
  CHECK(read_fault(path, 8) == path + ": the file has 67108865 bytes; the limit is 64 MiB (67108864 bytes)");
  std::string many = "[";
  for (std::size_t i = 0; i < JsonDocument::kMaxValues; ++i) many += "1,";
  many += "1]";
  CHECK(faults(many) == "s.json:1:8000002: error: more than 4000000 values, which is the limit of a scene\n");
}

TEST_CASE("I20 invalid text is refused") {
  CHECK(faults("{\"a\": \"b\xFF\"}") ==
        "s.json:1:9: error: byte 0xFF (offset 8) is not UTF-8; save the file in UTF-8\n");
  CHECK(faults("{\"a\":\n \"\xC3\xA4\xC0\xAF\"}") ==
        "s.json:2:4: error: byte 0xC0 (offset 10) is not UTF-8; save the file in UTF-8\n");
  CHECK(faults("[\"\xED\xA0\x80\"]") ==
        "s.json:1:3: error: byte 0xED (offset 2) is not UTF-8; save the file in UTF-8\n");
  CHECK(faults("[\"\\ud800x\"]") ==
        "s.json:1:3: error: \\ud800 is half of a surrogate pair; write the character itself\n");
  CHECK(faults("[\"\\udc00\"]") ==
        "s.json:1:3: error: \\udc00 is half of a surrogate pair; write the character itself\n");
  CHECK(faults("[\"\\u12\"]") == "s.json:1:3: error: \\u; expected four hexadecimal digits\n");
  CHECK(
      faults("[\"C:\\path\"]") ==
      "s.json:1:5: error: \\p is not an escape; expected one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\uXXXX; a "
      "backslash is "
      "\\\\\n");
  CHECK(faults("{\"a\": \"x\\u0000y\"}") == "s.json:1:9: error: /a: \\u0000; a text cannot contain a NUL\n");
  CHECK(faults("{\"x\\u0000y\": 1}").find("1:4: error") != std::string::npos);
  CHECK(faults(std::string("[\"a\0b\"]", 7)) == "s.json:1:4: error: a NUL byte in a text\n");
  CHECK(faults("[\"a\tb\"]") == "s.json:1:4: error: control byte 0x09 in a text; write it as \\t\n");
  CHECK(faults("[\"a\x1B[2J\"]") ==
        "s.json:1:4: error: control byte 0x1B in a text; write it as an escape \\u001B\n");
  CHECK(faults("[1, \xFF]") == "s.json:1:5: error: \"\\xff\"; expected a value\n");
}

TEST_CASE("I21 byte-order mark, CRLF and tabs do not change columns") {
  const JsonDocument d = sound("\xEF\xBB\xBF{\"a\": 1,\r\n\t\"b\": 2,\r\n\r\n \"c\": 3}\r\n");
  CHECK(place(d, "") == "1:1");
  CHECK(place(d, "/a") == "1:7");
  CHECK(place(d, "/b") == "2:7");
  CHECK(place(d, "/c") == "4:7");
  CHECK(faults("\xEF\xBB\xBF{\"a\" 1}") == "s.json:1:6: error: \"1\"; expected \":\" after a key\n");
}

TEST_CASE("I22 comments are refused with a hint") {
  const std::string hint =
      "error: JSON has no comments; write one as a key: \"//\": \"text\" (it may repeat)\n";
  CHECK(faults("// head\n{}") == "s.json:1:1: " + hint);
  CHECK(faults("{ /* x */ \"a\": 1}") == "s.json:1:3: " + hint);
  CHECK(faults("{\"a\": 1 // one\n}") == "s.json:1:9: " + hint);
  CHECK(faults("{\"a\": 1, // one\n \"b\": 2}") == "s.json:1:10: " + hint);
  CHECK(faults("{\"a\": /* 1 */ 2}") == "s.json:1:7: " + hint);
  CHECK(faults("{\"a\" /**/: 2}") == "s.json:1:6: " + hint);
  CHECK(faults("[1, 2, # three\n 3]") == "s.json:1:8: " + hint);
  CHECK(faults("{} // end") == "s.json:1:4: " + hint);
}

TEST_CASE("I46 other kinds of file are recognised") {
  CHECK(faults("\x1F\x8B\x08") == "s.json:1:1: error: looks like gzip; expected JSON; unpack it first\n");
  CHECK(faults("PK\x03\x04...") ==
        "s.json:1:1: error: looks like a zip archive; expected JSON; unpack it first\n");
  CHECK(faults("\x89PNG\r\n") == "s.json:1:1: error: looks like a PNG picture; expected JSON\n");
  CHECK(faults(std::string("\xFF\xFE{\0", 4)) ==
        "s.json:1:1: error: looks like UTF-16; save the file in UTF-8\n");
  CHECK(faults("<?xml?>") == "s.json:1:1: error: looks like XML; expected JSON\n");
}

TEST_CASE("I01 unreadable files are reported") {
  const Folder folder;
  const std::string path = folder.write("scene.json", "{\"a\": 1}");
  Diagnostics diagnostics;
  const JsonDocument d = JsonDocument::read(path, diagnostics);
  CHECK(d.root().find("a")->number() == 1);
  CHECK(d.name() == path);
  const std::string near = (folder.path / "scen.json").string();
  CHECK(read_fault(near, 3) ==
        near + ": cannot read: No such file or directory; did you mean \"scene.json\"?");
  const std::string far = (folder.path / "other.txt").string();
  CHECK(read_fault(far, 3) == far + ": cannot read: No such file or directory");
  const std::string nowhere = (folder.path / "no" / "scene.json").string();
  CHECK(read_fault(nowhere, 3) == nowhere + ": cannot read: No such file or directory; the folder " +
                                      (folder.path / "no").string() + " does not exist either");
  CHECK(read_fault(folder.path.string(), 7) == folder.path.string() + ": cannot read: Is a directory");
  CHECK(read_fault(path + "/x", 7) == path + "/x: cannot read: Not a directory");
  if (::geteuid() != 0) {
    ::chmod(path.c_str(), 0);
    CHECK(read_fault(path, 7) == path + ": cannot read: Permission denied");
  }
  CHECK(read_fault((folder.path / "a\x1B[2J").string(), 3).find('\x1B') == std::string::npos);
}

TEST_CASE("the option --set replaces and adds values") {
  JsonDocument d = sound(R"({"parts": [{"name": "a", "n": 1}], "//": 0})");
  Diagnostics diagnostics;
  d.set("/parts/0/n=[1, 2.5]", diagnostics);
  d.set("/parts/0/name=arm", diagnostics);
  d.set("/parts/0/rest=\"2*t=1\"", diagnostics);
  d.set("/parts/1", "{\"name\": \"b\"}", diagnostics);
  d.set("/parts/-", "{}", diagnostics);
  d.set("/flag", "true", diagnostics);
  d.set("/drive", "sin(2*t)", diagnostics);
  d.set("/push", "-2*t", diagnostics);
  CHECK(diagnostics.text().empty());
  CHECK(d.at("/parts/0/n/1")->number() == 2.5);
  CHECK(d.at("/parts/0/name")->string() == "arm");
  CHECK(d.at("/parts/0/rest")->string() == "2*t=1");
  CHECK(d.at("/parts/1/name")->string() == "b");
  CHECK(d.at("/parts/2")->is_object());
  CHECK(d.at("/flag")->boolean());
  CHECK(d.at("/push")->string() == "-2*t");
  CHECK(d.at("/drive")->string() == "sin(2*t)");
  CHECK(d.shown(*d.at("/parts/0/n/1")) == "2.5");
  CHECK(to_string(d.fault(*d.at("/parts/0/n/1"), "2.5; expected 3")) ==
        "--set /parts/0/n: error: /parts/0/n/1: 2.5; expected 3");
  CHECK(to_string(d.fault_at_key(*d.at("/parts/0"), "rest", "unknown key")) ==
        "--set /parts/0/rest: error: /parts/0/rest: unknown key");
}

TEST_CASE("errors of the option --set are reported and change nothing") {
  const std::string text = R"({"parts": [{"shape": {"eps1": 1}}, {}]})";
  CHECK(set_faults(text, "/parts/0/shap/eps1=2") ==
        "--set /parts/0/shap/eps1: error: /parts/0/shap/eps1: /parts/0 has no key \"shap\"; did you mean "
        "/parts/0/shape?\n");
  CHECK(set_faults(text, "/world/gravity=1") ==
        "--set /world/gravity: error: /world/gravity: the document has no key \"world\"\n");
  CHECK(set_faults(text, "/parts/7/name=a") ==
        "--set /parts/7/name: error: /parts/7/name: /parts has 2 elements; there is no element \"7\"\n");
  CHECK(set_faults(text, "/parts/3=1") ==
        "--set /parts/3: error: /parts/3: /parts has 2 elements; there is no element \"3\"\n");
  CHECK(set_faults(text, "/parts/0/shape/eps1/x=1") ==
        "--set /parts/0/shape/eps1/x: error: /parts/0/shape/eps1/x: /parts/0/shape/eps1 is neither an object "
        "nor an "
        "array; it has no \"x\"\n");
  CHECK(set_faults(text, "parts=1") ==
        "--set parts: error: expected a JSON pointer to a value, for example /parts/0/name; in a key, ~ is "
        "written ~0 and / is written ~1\n");
  CHECK(set_faults(text, "/parts") == "--set /parts: error: expected /json/pointer=value\n");
  CHECK(set_faults(text, "/parts=[1,]") ==
        "--set /parts: error: /parts: [1,]; at character 3: a comma before \"]\"; remove it\n");
  CHECK(set_faults(text, "/parts=") ==
        "--set /parts: error: /parts: ; at character 1: empty; expected a JSON object\n");
  CHECK(set_faults(text, "/parts={\"a\": 1, \"a\": 2}") ==
        "--set /parts: error: /parts/a: key given twice; the first is at character 2\n");
  CHECK(set_faults(text, "/parts=1e400").find("too large") != std::string::npos);
  CHECK(set_faults(text, "/parts=-inf").find("write a finite number") != std::string::npos);
  CHECK(set_faults(text, "/parts=1.2.3").find("expected a number") != std::string::npos);
  CHECK(set_faults(text, "/parts/0/x=" + std::string(62, '[') + std::string(62, ']')).find("nested deeper") !=
        std::string::npos);
}

TEST_CASE("messages contain no control characters and can be read by machines") {
  Diagnostics all;
  all.add({"a\x1B.json", 3, 4, "/x\n", "bad \x1B[31m \xE2\x80\xAE \xFF \"q\" %n", pliant::Severity::kError});
  all.add({"a\x1B.json", 1, 9, "", "unusual", pliant::Severity::kWarning});
  CHECK(all.text() ==
        "a\\x1b.json:1:9: warning: unusual\n"
        "a\\x1b.json:3:4: error: /x\\n: bad \\x1b[31m \\u{202e} \\xff \"q\" %n\n");
  CHECK(all.json() ==
        "{\"errors\": 1, \"warnings\": 1, \"diagnostics\": [\n"
        "  {\"file\": \"a\\u001b.json\", \"line\": 1, \"column\": 9, \"pointer\": \"\", \"severity\": "
        "\"warning\", "
        "\"message\": \"unusual\"},\n"
        "  {\"file\": \"a\\u001b.json\", \"line\": 3, \"column\": 4, \"pointer\": \"/x\\u000a\", "
        "\"severity\": \"error\", "
        "\"message\": \"bad \\u001b[31m \xE2\x80\xAE \xEF\xBF\xBD \\\"q\\\" %n\"}\n]}\n");
  CHECK_THROWS_AS(all.throw_if_errors(), SceneError);
  Diagnostics warnings;
  CHECK(warnings.json() == "{\"errors\": 0, \"warnings\": 0, \"diagnostics\": []}\n");
  warnings.add({"a", 1, 1, "", "w", pliant::Severity::kWarning});
  CHECK_NOTHROW(warnings.throw_if_errors());
}

TEST_CASE("twenty errors are printed, the rest are counted") {
  Diagnostics all;
  for (int i = 5000; i > 0; --i) all.add({"f", i, 1, "", "m", pliant::Severity::kError});
  const std::string text = all.text();
  CHECK(std::count(text.begin(), text.end(), '\n') == 21);
  CHECK(text.substr(text.size() - 18) == "... and 4980 more\n");
  CHECK(all.full());
  CHECK(all.sorted().size() == Diagnostics::kMaxStored);
}

TEST_CASE("every truncated or changed scene is read or refused") {
  const std::string text =
      "{\"a\": [1, -2.5e3, \"\xC3\xA9\\u00e9\\\"\", {\"b\": true, \"//\": null}], \"c\": {}, \"d\": 0}";
  CHECK(faults(text).empty());
  for (std::size_t n = 0; n < text.size(); ++n) {
    const std::string cut = faults(text.substr(0, n));
    INFO(n << " " << cut);
    CHECK(cut.rfind("s.json:1:", 0) == 0);
    CHECK(std::count(cut.begin(), cut.end(), '\n') == 1);
    CHECK(cut.find("unexpected") == std::string::npos);
    for (int byte = 0; byte < 256; ++byte) {
      std::string changed = text;
      changed[n] = static_cast<char>(byte);
      const std::string message = faults(changed);
      CHECK((message.empty() || message.rfind("s.json:", 0) == 0));
      CHECK(message.find("unexpected") == std::string::npos);
    }
  }
}

}  // namespace json_document_test
