#include "common/error.h"
#include "tools/rt-import/check_collada.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

// Nothing, or what is wrong.
std::string faultOf(const std::string& accessor) {
    try {
        checkCollada(
            "<source id=\"s\"><float_array\n id='a' count=\"12\">1 2</float_array><technique_common>" +
                accessor + "</technique_common></source>",
            "m.dae");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::InvalidContent);
        return error.what();
    }
    return "";
}

TEST(ImportCollada, AccessorsStayInTheirArrays) {
    EXPECT_EQ(faultOf(R"(<accessor source="#a" count="4" stride="3">)"), "");
    EXPECT_EQ(faultOf(R"(<accessor source="#a" count="12"/>)"), "");
    EXPECT_EQ(faultOf(R"(<accessor source="#a" offset="3" count="3" stride="3">)"), "");
    EXPECT_EQ(faultOf(R"(<accessor source="#other" count="99" stride="3">)"),
              ""); // names, or of another file
    EXPECT_EQ(faultOf("<accessor"), "");
    for (const char* accessor :
         {R"(<accessor source="#a" count="5" stride="3">)", R"(<accessor source='#a' stride="3" count="5" >)",
          R"(<accessor source="#a" count="13">)", R"(<accessor source="#a" offset="4" count="3" stride="3">)",
          R"(<accessor source="#a" offset="99" count="1" stride="3">)",
          R"(<accessor source="#a" count="6148914691236517206" stride="3">)"})
        EXPECT_THAT(faultOf(accessor), testing::HasSubstr("of array 'a', which has 12")) << accessor;
}

} // namespace
} // namespace rt
