#pragma once

#include <map>
#include <string>

namespace perennial {

/// Which of many recurring notes are worth a line in a log: of each kind the first few in a traversal.
/// Without it, a robot that recognises every other view would write a line with every image, for hours.
class NoteLimit {
 public:
  enum class Verdict {
    kSay,
    kSayForTheLastTime,  ///< in this traversal; the line should tell
    kKeepQuiet,
  };

  /// `most`: lines of each kind in a traversal, at least 1.
  explicit NoteLimit(int most) : most_(most) {}

  Verdict note(const std::string& kind) {
    const int number = ++notes_[kind];
    if (number == most_) {
      return Verdict::kSayForTheLastTime;
    }
    return number < most_ ? Verdict::kSay : Verdict::kKeepQuiet;
  }

  /// Another traversal: everything may be said again.
  void begin() { notes_.clear(); }

 private:
  int most_;
  std::map<std::string, int> notes_;
};

}  // namespace perennial
