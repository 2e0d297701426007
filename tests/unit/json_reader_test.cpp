#include "common/json_reader.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

using testing::HasSubstr;

template <class Ask>
std::string refusal(const std::string& text, const Ask& ask, ErrorKind kind = ErrorKind::InvalidContent) {
    try {
        ask(JsonNode::parse(text, "f.json"));
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind);
        return error.what();
    }
    return "nothing was refused";
}

const auto nothing = [](const JsonNode&) {};

TEST(JsonReader, ErrorsNameFileAndPointer) {
    const std::string text = R"({"a": [{"b/c": 1, "d~": "x"}]})";
    EXPECT_EQ(refusal(text, [](const JsonNode& n) { n.at("a").items()[0].at("b/c").text(); }),
              "f.json: /a/0/b~1c: is no text");
    EXPECT_EQ(refusal(text, [](const JsonNode& n) { n.at("a").items()[0].at("d~").number(); }),
              "f.json: /a/0/d~0: is no number");
    EXPECT_EQ(refusal(text, [](const JsonNode& n) { n.at("z"); }), "f.json: /: z is missing");
    EXPECT_EQ(refusal(text,
                      [](const JsonNode& n) {
                          n.allow({"x", "y"});
                      }),
              "f.json: /: 'a' is none of x, y");
}

TEST(JsonReader, TextThatIsNoJsonIsRefused) {
    for (const char* text :
         {"", "{", "[1,]", "{\"a\" 1}", "nul", "[1] 2", "// c\n1", "[1e999]", "[NaN]", "\"\xff\""})
        EXPECT_THAT(refusal(text, nothing), HasSubstr("f.json: is no JSON: ")) << text;
    EXPECT_THAT(refusal("{\n\"a\": ?}", nothing), HasSubstr("line 2, column 6"));
}

TEST(JsonReader, AKeyTwiceIsRefused) {
    EXPECT_THAT(refusal(R"({"a": 1, "b": {"a": 2}, "a": 3})", nothing), HasSubstr("'a' is there twice"));
    EXPECT_EQ(JsonNode::parse(R"({"a": {"a": [{"a": 1}, {"a": 2}]}})", "f").at("a").at("a").items().size(),
              2u);
}

TEST(JsonReader, DepthIsBounded) {
    const std::string deep(kMaxJsonDepth, '['), end(kMaxJsonDepth, ']');
    JsonNode::parse(deep + end, "f");
    EXPECT_THAT(refusal("[" + deep + end + "]", nothing), HasSubstr("deeper than"));
    EXPECT_THAT(refusal(std::string(1000000, '['), nothing), HasSubstr("deeper than"));
}

TEST(JsonReader, ValuesAreCheckedAgainstTheirRange) {
    const auto number = [](double low, double high) {
        return [=](const JsonNode& n) { n.number(low, high); };
    };
    EXPECT_EQ(JsonNode::parse("0.5", "f").number(0.0, 1.0), 0.5);
    EXPECT_THAT(refusal("1.5", number(0.0, 1.0)), HasSubstr("1.5 is not between 0 and 1"));
    EXPECT_THAT(refusal("-1", number(0.0, kMostFloat)), HasSubstr("-1 is below 0 or too large"));
    EXPECT_THAT(refusal("1e39", number(0.0, kMostFloat)), HasSubstr("too large"));
    EXPECT_THAT(refusal("0", [](const JsonNode& n) { n.positive(); }), HasSubstr("0 is not above 0"));
    EXPECT_THAT(refusal("[1, 2]", [](const JsonNode& n) { n.point(); }), HasSubstr("is not [x, y, z]"));
    EXPECT_THAT(refusal("[0, 0, 0]", [](const JsonNode& n) { n.direction(); }), HasSubstr("has no length"));
    EXPECT_EQ(JsonNode::parse("[0, 0, 1e300]", "f").direction(), glm::dvec3(0, 0, 1));
    EXPECT_EQ(JsonNode::parse("[0.5, 1, 0]", "f").color(1.0), glm::vec3(0.5f, 1.0f, 0.0f));
    EXPECT_EQ(JsonNode::parse("0.25", "f").color(1.0), glm::vec3(0.25f));
    EXPECT_THAT(refusal("[0, 0, 2]", [](const JsonNode& n) { n.color(1.0); }),
                HasSubstr("/2: 2 is not between"));
    EXPECT_THAT(refusal(R"("purple")", [](const JsonNode& n) { n.color(1.0); }), HasSubstr("[r, g, b]"));
    EXPECT_THAT(refusal(R"("")", [](const JsonNode& n) { n.text(); }), HasSubstr("is empty"));
    EXPECT_THAT(refusal(R"("a\u0000b")", [](const JsonNode& n) { n.text(); }), HasSubstr("control"));
    EXPECT_THAT(refusal("1", [](const JsonNode& n) { n.truth(); }), HasSubstr("neither true nor false"));
    EXPECT_EQ(JsonNode::parse(R"("b")", "f").choice({"a", "b"}), 1u);
    EXPECT_THAT(refusal(R"("c")",
                        [](const JsonNode& n) {
                            n.choice({"a", "b"});
                        }),
                HasSubstr("none of a, b"));
}

TEST(JsonReader,
     LongArraysOfObjectsTakeTimeInProportion) { // minutes, if each object looked through its array
    std::string text = "[{\"a\": 1}";
    for (int i = 1; i < 400000; ++i) text += ",{\"a\": 1}";
    EXPECT_EQ(JsonNode::parse(text + "]", "f.json").items().size(), 400000u);
}

TEST(JsonReader, DevicesWithoutAnEndAreRefused) {
    try {
        JsonNode::read("/dev/zero");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded) << error.what();
    }
}

} // namespace
} // namespace rt
