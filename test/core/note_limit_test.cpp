#include "perennial/core/note_limit.h"

#include <gtest/gtest.h>

namespace perennial {
namespace {

using Verdict = NoteLimit::Verdict;

TEST(NoteLimit, saysTheFirstFewOfEachKindInEachTraversal) {
  NoteLimit limit(2);
  for (int traversal = 0; traversal < 3; ++traversal) {
    for (const char* kind : {"repeating", "degraded"}) {
      EXPECT_EQ(limit.note(kind), Verdict::kSay);
      EXPECT_EQ(limit.note(kind), Verdict::kSayForTheLastTime);
      for (int i = 0; i < 1000; ++i) {
        EXPECT_EQ(limit.note(kind), Verdict::kKeepQuiet);
      }
    }
    limit.begin();
  }
}

}  // namespace
}  // namespace perennial
