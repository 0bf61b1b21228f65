#include "perennial/core/parameter_reader.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "perennial/core/error.h"

namespace perennial {
namespace {

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParameterReader, givesDefaultsForMissingKeys) {
  ParameterReader reader;
  EXPECT_TRUE(reader.boolean("a", true));
  EXPECT_EQ(reader.integer("b", 7, 0, 10), 7);
  EXPECT_EQ(reader.real("c", 0.5, 0.0, 1.0), 0.5);
  EXPECT_EQ(reader.text("d", "x"), "x");
  EXPECT_EQ(reader.choice("e", "x", {"x", "y"}), "x");
  EXPECT_EQ(reader.reals("f", {1.0}, 0.0, 2.0), std::vector<double>{1.0});
  EXPECT_NO_THROW(reader.requireAllUsed());
}

TEST(ParameterReader, readsValues) {
  ParameterReader reader(
      {{"a", false}, {"b", 3}, {"c", 2}, {"d", std::string("y")}, {"f", std::vector<double>{2.0}}});
  EXPECT_FALSE(reader.boolean("a", true));
  EXPECT_EQ(reader.integer("b", 7, 0, 10), 3);
  EXPECT_EQ(reader.real("c", 0.5, 0.0, 5.0), 2.0) << "an integer serves as a real";
  EXPECT_EQ(reader.choice("d", "x", {"x", "y"}), "y");
  EXPECT_EQ(reader.reals("f", {}, 0.0, 2.0), std::vector<double>{2.0});
}

TEST(ParameterReader, errorsNameKeyAndRange) {
  ParameterReader reader(
      {{"count", 11}, {"ratio", std::numeric_limits<double>::quiet_NaN()}, {"kind", std::string("z")}},
      "/node/part/");
  const std::string count = messageOf([&] { reader.integer("count", 1, 0, 10); });
  EXPECT_NE(count.find("/node/part/count"), std::string::npos) << count;
  EXPECT_NE(count.find("[0, 10]"), std::string::npos) << count;
  const std::string ratio = messageOf([&] { reader.real("ratio", 0.1, 0.0, 1.0); });
  EXPECT_NE(ratio.find("/node/part/ratio"), std::string::npos) << ratio;
  const std::string kind = messageOf([&] { reader.choice("kind", "x", {"x", "y"}); });
  EXPECT_NE(kind.find("x, y"), std::string::npos) << kind;
}

TEST(ParameterReader, refusesTheWrongType) {
  ParameterReader reader({{"a", std::string("true")}, {"b", 1.5}, {"c", true}, {"d", 1}});
  EXPECT_THROW(reader.boolean("a", false), ParameterError);
  EXPECT_THROW(reader.integer("b", 0, 0, 10), ParameterError);
  EXPECT_THROW(reader.real("c", 0.0, 0.0, 1.0), ParameterError);
  EXPECT_THROW(reader.text("d", ""), ParameterError);
}

TEST(ParameterReader, refusesUnknownKeysAndListsTheKnown) {
  ParameterReader reader({{"raito", 0.7}}, "/node/");
  reader.real("ratio", 0.7, 0.0, 1.0);
  const std::string message = messageOf([&] { reader.requireAllUsed(); });
  EXPECT_NE(message.find("/node/raito"), std::string::npos) << message;
  EXPECT_NE(message.find("ratio"), std::string::npos) << message;
}

}  // namespace
}  // namespace perennial
