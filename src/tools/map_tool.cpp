#include <charconv>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "map_commands.h"

namespace {

constexpr int kSuccess = 0;
constexpr int kFailure = 1;
constexpr int kWrongUse = 2;

constexpr const char* kHelp = R"(Looks into the map files of visual teach and repeat.

usage: map_tool list FILE             local maps: index, distance, time of teaching, features, strategy
       map_tool list FOLDER           maps in a folder, one line each
       map_tool info FILE             what the map was taught with, its traversals and sizes
       map_tool verify FILE           reads everything and lists what is damaged
       map_tool history FILE          traversals that the map has learned from; 0 is the teaching
       map_tool rollback FILE --to N  forgets everything learned after traversal N
       map_tool compact FILE [--keep N]
                                      makes the file smaller: the newest N (default 10) traversals stay and can be
                                      rolled back to, what was learned before becomes one traversal, number 1
       map_tool export FILE [--out FOLDER]
                                      images as PNG, features as CSV, profile and metadata as YAML, into a new or
                                      empty folder (default: the map's name with _export, in the current folder)
       map_tool import FOLDER [--name NAME] [--out FILE] [--encoding ENCODING]
                                      a map to drive with from one of the reference system, which is a folder of
                                      <name>_<distance>.yaml (OpenCV FileStorage) and <name>.yaml. Images, distances,
                                      times and velocities are taken over; features are extracted anew from the
                                      images, because those of another extractor cannot be compared with ours.
                                      ENCODING is that of the camera to drive with (mono8; bgr8 for coloured images)

FILE is the file of a map (*.perennial). Nothing but rollback and compact changes it; before they do,
a map of an older format version is migrated and its original kept beside it. import writes a new one. Needs no ROS master.
exit status: 0 success; 1 the map is damaged or something else went wrong; 2 wrong use
)";

class WrongUse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Arguments {
  std::string command;
  std::string file;
  std::map<std::string, std::string> options;

  std::optional<std::string> option(const std::string& name) const {
    const auto found = options.find(name);
    return found == options.end() ? std::nullopt : std::make_optional(found->second);
  }
};

/// The options that a command has; each takes a value.
const std::set<std::string>& optionsOf(const std::string& command) {
  static const std::map<std::string, std::set<std::string>> options = {
      {"rollback", {"--to"}},
      {"compact", {"--keep"}},
      {"export", {"--out"}},
      {"import", {"--name", "--out", "--encoding"}}};
  static const std::set<std::string> none;
  const auto found = options.find(command);
  return found == options.end() ? none : found->second;
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  arguments.command = words.at(0);
  const std::set<std::string>& known = optionsOf(arguments.command);
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (known.count(word) > 0) {
      if (++i == words.size()) {
        throw WrongUse(word + " needs a value");
      }
      arguments.options[word] = words[i];
    } else if (word.size() > 1 && word[0] == '-') {
      throw WrongUse("unknown option " + word);
    } else if (arguments.file.empty()) {
      arguments.file = word;
    } else {
      throw WrongUse("one file at a time, not also '" + word + "'");
    }
  }
  if (arguments.file.empty()) {
    throw WrongUse("which FILE?");
  }
  return arguments;
}

std::uint32_t number(const std::optional<std::string>& text, const std::string& what) {
  std::uint32_t number = 0;
  const char* end = text ? text->data() + text->size() : nullptr;
  if (!text || std::from_chars(text->data(), end, number).ptr != end || text->empty()) {
    throw WrongUse(what);
  }
  return number;
}

int run(const Arguments& arguments) {
  using namespace perennial;
  const std::string& command = arguments.command;
  if (command == "list") {
    listMap(arguments.file, std::cout);
  } else if (command == "info") {
    printInfo(arguments.file, std::cout);
  } else if (command == "verify") {
    return verifyMap(arguments.file, std::cout) ? kSuccess : kFailure;
  } else if (command == "history") {
    printHistory(arguments.file, std::cout);
  } else if (command == "rollback") {
    const std::string what = "rollback needs --to and the number of a traversal, as listed by history";
    rollBack(arguments.file, number(arguments.option("--to"), what), std::cout);
  } else if (command == "compact") {
    constexpr const char* kDefaultKept = "10";
    compactMap(
        arguments.file,
        number(arguments.option("--keep").value_or(kDefaultKept), "--keep needs a number of traversals"),
        std::cout);
  } else if (command == "export") {
    const std::string name = std::filesystem::path(arguments.file).stem().string() + "_export";
    exportMap(arguments.file, arguments.option("--out").value_or(name), std::cout);
  } else if (command == "import") {
    importMap(arguments.file,
              {arguments.option("--name").value_or(""), arguments.option("--out").value_or(""),
               arguments.option("--encoding").value_or("")},
              std::cout);
  } else {
    throw WrongUse("unknown command '" + command + "'");
  }
  return kSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && (words[0] == "--help" || words[0] == "-h" || words[0] == "help")) {
    std::cout << kHelp;
    return kSuccess;
  }
  try {
    if (words.empty()) {
      throw WrongUse("which command?");
    }
    return run(parse(words));
  } catch (const WrongUse& error) {
    std::cerr << "map_tool: " << error.what() << "\n\n" << kHelp;
    return kWrongUse;
  } catch (const std::exception& error) {
    std::cerr << "map_tool: " << error.what() << "\n";
    return kFailure;
  }
}
