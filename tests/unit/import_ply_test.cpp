#include "common/error.h"
#include "tools/rt-import/check_ply.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

// Nothing, or what is wrong.
std::string faultOf(const std::string& bytes) {
    try {
        checkPly(bytes, "m.ply");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::InvalidContent);
        return error.what();
    }
    return "";
}

TEST(ImportPly, AHeaderHasAnEnd) {
    const std::string header = "ply\nformat ascii 1.0\ncomment no end_header yet\nelement vertex 3\n";
    for (const char* end : {"end_header\n", "end_header\r\n0 0 0\n", "end_header \n\xff", "end_header"})
        EXPECT_EQ(faultOf(header + end), "") << end;
    for (const char* end :
         {"", "end_heade", "end_headr\n0 0 0\n", "end_header2\n", "bend_header\n", "end_header 0 0 0\n"})
        EXPECT_THAT(faultOf(header + end), testing::HasSubstr("m.ply: its header has no line 'end_header'"))
            << end;
}

TEST(ImportPly, AHeaderIsNotLongerThanAHeaderCanBe) {
    const std::string end = "\nend_header\n";
    EXPECT_EQ(faultOf("ply\ncomment " + std::string(1000000, 'x') + end), "");
    EXPECT_NE(faultOf("ply\ncomment " + std::string((1u << 20) - 20, 'x') + end), "");
}

} // namespace
} // namespace rt
