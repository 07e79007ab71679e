#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/scenario/document.h"
#include "app/scenario/outline.h"
#include "app/scenario/reader.h"
#include "app/scenario/reference.h"
#include "app/scenario/writer.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"

// Keys that belong to some values of another key only.
namespace hvp::scenario::variant_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Lid {
  double weight = 0.1;
  int hinges = 1;

  void declare(config::Visitor& v, int screws) {
    v.quantity("weight", weight, config::Dimension::mass, config::at_least(0.0), {"of the lid"});
    v.when({"screws", {"4"}, std::to_string(screws)}, [&] {
      v.integer("hinges", hinges, {1, 8}, {"of the lid"});
    });
  }
  bool operator==(const Lid&) const = default;
};

struct Padding {
  double thickness = 0.0;

  void declare(config::Visitor& v) {
    v.quantity("thickness", thickness, config::Dimension::length, config::at_least(0.0), {"of it"});
  }
  bool operator==(const Padding&) const = default;
};

// Keys that stand among those of another part, with a rule of their own.
struct Label {
  int from = 0;
  int to = 0;

  void declare(config::Visitor& v) {
    v.integer("from", from, {0, 9}, {"the first number"});
    v.integer("to", to, {0, 9}, {"the last number"});
  }
  void check() const {
    if (to < from) throw InputError("to", "is below from");
  }
  bool operator==(const Label&) const = default;
};

struct Package {
  enum class Shape { ball, box, tube };
  Shape shape = Shape::ball;
  double radius = 0.05;
  double length = 0.0;
  int screws = 2;
  Lid lid;
  std::optional<Padding> padding;
  Label label;
  int weight_class = 1;

  void declare(config::Visitor& v) {
    const auto of_shape = v.variant(
        "shape", shape, {{"ball", Shape::ball}, {"box", Shape::box}, {"tube", Shape::tube}},
        {"what it is"});
    of_shape.only({Shape::ball, Shape::tube}, [&] {
      v.quantity("radius", radius, config::Dimension::length, config::above(0.0), {"of the round"});
    });
    of_shape.only({Shape::tube}, [&] {
      v.quantity("length", length, config::Dimension::length, config::above(0.0),
                 {.help = "how long it is", .required = true});
    });
    of_shape.only({Shape::box}, [&] {
      v.integer("screws", screws, {2, 4}, {"of the lid"});
      v.table("lid", lid, {"what closes it"}, screws);
      v.effect("padding", padding, {"what it is lined with"});
    });
    v.include(label);
    v.integer("weight_class", weight_class, {1, 3}, {"of the post"});
  }
  bool operator==(const Package&) const = default;
};

Package read_package(const std::string& text, const std::vector<std::string>& overrides = {}) {
  Package package;
  read(Document::parse(text, "x.toml", overrides), package);
  return package;
}

std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_package(text, overrides);
  } catch (const SourceError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Variant, AKeyOfAnotherKindIsRefusedWhateverItsValue) {
  // The value is the default's, and the other one is not.
  for (const char* radius : {"50 mm", "1 mm"}) {
    EXPECT_EQ(error_of(std::string("shape = \"box\"\nradius = \"") + radius + "\""),
              "x.toml:2: radius: belongs to shape = \"ball\" or \"tube\" only, found \"box\"");
  }
  EXPECT_EQ(error_of("length = \"1 m\""),
            "x.toml:1: length: belongs to shape = \"tube\" only, found \"ball\"");
  EXPECT_EQ(error_of("shape = \"ball\"", {"screws=2"}),
            "--set screws=2: belongs to shape = \"box\" only, found \"ball\"");
}

// A what-if of another kind, of a resolved scenario too: what the file says of its kind goes with
// it.
TEST(Variant, AnOverrideOfTheKindLeavesTheFilesKeysBehind) {
  const Package box = read_package("shape = \"ball\"\nradius = \"7 mm\"", {"shape=box"});
  EXPECT_EQ(box.shape, Package::Shape::box);
  EXPECT_EQ(box.radius, Package{}.radius);
  // Not what is set beside it.
  EXPECT_EQ(error_of("shape = \"ball\"", {"shape=box", "radius=7 mm"}),
            "--set radius=7 mm: belongs to shape = \"ball\" or \"tube\" only, found \"box\"");
}

TEST(Variant, WhatBelongsIsRead) {
  EXPECT_EQ(read_package("shape = \"tube\"\nradius = \"7 mm\"\nlength = \"1 m\"").radius, 7e-3);
  EXPECT_EQ(read_package("radius = \"7 mm\"").radius, 7e-3);
  EXPECT_EQ(read_package("shape = \"box\"\nscrews = 3").screws, 3);
}

TEST(Variant, OnlyWhatBelongsIsRequired) {
  EXPECT_EQ(error_of("shape = \"ball\""), "no error");
  EXPECT_EQ(error_of("shape = \"tube\""), "x.toml:1: length: missing required key: how long it is");
}

TEST(Variant, TablesAndEffectsBelongToo) {
  EXPECT_EQ(error_of("[lid]\nweight = \"1 kg\""),
            "x.toml:1: lid: belongs to shape = \"box\" only, found \"ball\"");
  EXPECT_EQ(error_of("shape = \"tube\"\nlength = \"1 m\"\n[padding]"),
            "x.toml:3: padding: belongs to shape = \"box\" only, found \"tube\"");
  EXPECT_EQ(error_of("shape = \"box\"\n[padding]\n[lid]\nweight = \"1 kg\""), "no error");
}

// A switch that is off asks for nothing.
TEST(Variant, AnEffectOfAnotherKindMayBeSwitchedOff) {
  EXPECT_EQ(error_of("shape = \"ball\"", {"padding=false"}), "no error");
  EXPECT_EQ(error_of("shape = \"ball\"", {"padding=true"}),
            "--set padding=true: belongs to shape = \"box\" only, found \"ball\"");
}

TEST(Variant, AnotherTableMayDecide) {
  EXPECT_EQ(error_of("shape = \"box\"\nscrews = 3\n[lid]\nhinges = 1"),
            "x.toml:4: lid.hinges: belongs to screws = 4 only, found 3");
  EXPECT_EQ(read_package("shape = \"box\"\nscrews = 4\n[lid]\nhinges = 5").lid.hinges, 5);
}

TEST(Variant, AWrongKindIsTheOnlyError) {
  EXPECT_EQ(error_of("radius = \"7 mm\"\nscrews = 2\nshape = \"cone\""),
            "x.toml:3: shape: expected \"ball\", \"box\" or \"tube\", found \"cone\"");
}

TEST(Variant, ANameThatExistsNowhereIsUnknown) {
  EXPECT_THAT(error_of("shape = \"box\"\nradios = \"7 mm\""),
              HasSubstr("x.toml:2: radios: unknown key; did you mean \"radius\"?"));
}

TEST(Include, TheRuleOfAnIncludedPartHolds) {
  EXPECT_EQ(error_of("from = 3\nto = 5"), "no error");
  EXPECT_EQ(error_of("from = 3\nto = 2"), "x.toml:2: to: is below from");
}

// Keys that are declared behind the included part are not unknown to its rule.
TEST(Include, ItsKeysAndTheOthersStandInOneTable) {
  const Package read = read_package("from = 3\nto = 5\nweight_class = 2");
  EXPECT_EQ(read.label.to, 5);
  EXPECT_EQ(read.weight_class, 2);
  EXPECT_THAT(error_of("from = 3\nto = 2\nweight_clas = 2"), HasSubstr("unknown key"));
}

// A list's items are read one after the other, so the rule of each is of its own values.
struct Parcels {
  std::vector<Package> parcels;
  void declare(config::Visitor& v) { v.list("parcel", parcels, {"several"}); }
};

TEST(Include, EveryItemOfAListHasItsOwnRule) {
  const auto error = [](const std::string& text) -> std::string {
    Parcels parcels;
    try {
      read(Document::parse(text, "x.toml"), parcels);
    } catch (const SourceError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error("[[parcel]]\nfrom = 3\nto = 5\n[[parcel]]\nto = 1"), "no error");
  EXPECT_EQ(error("[[parcel]]\nto = 5\n[[parcel]]\nfrom = 2\nto = 1"),
            "x.toml:5: parcel[1].to: is below from");
}

TEST(Variant, TheResolvedScenarioHasWhatBelongsAndReadsBack) {
  for (const char* text : {"shape = \"ball\"\nradius = \"7 mm\"",
                           "shape = \"tube\"\nradius = \"7 mm\"\nlength = \"1 m\"",
                           "shape = \"box\"\nscrews = 4\n[lid]\nhinges = 2\n[padding]"}) {
    const Package package = read_package(text);
    const std::string written = resolved(package);
    EXPECT_EQ(read_package(written), package) << written;
  }
  const std::string ball = resolved(read_package("shape = \"ball\""));
  EXPECT_THAT(ball, HasSubstr("radius = \"50 mm\"\n"));
  for (const char* other : {"length", "screws", "lid", "padding"}) {
    EXPECT_THAT(ball, Not(HasSubstr(other)));
  }
}

TEST(Variant, TheReferenceSaysWhatBelongsTo) {
  const std::string page = reference_page(Package{});
  EXPECT_THAT(page, HasSubstr("| only with `shape` = \"ball\" or \"tube\": of the round |"));
  EXPECT_THAT(page, HasSubstr("| required | only with `shape` = \"tube\": how long it is |"));
  EXPECT_THAT(page, HasSubstr("\n## `[lid]`\n\nonly with `shape` = \"box\": what closes it\n"));
  EXPECT_THAT(page, HasSubstr("| only with `screws` = 4: of the lid |"));
  EXPECT_THAT(page, HasSubstr("| `weight` | mass | at least 0 kg | `\"100 g\"` | of the lid |"));
  EXPECT_THAT(page,
              HasSubstr("| `weight_class` | whole number | from 1 to 3 | `1` | of the post |"));
}

}  // namespace
}  // namespace hvp::scenario::variant_test
