#include "common/error.h"

namespace rt {

std::string exitCodeTable() {
    return "Exit codes:\n"
           "  0   ok\n"
           "  1   images differ (rt-compare only)\n"
           "  2   wrong usage\n"
           "  3   a file could not be read or written\n"
           "  4   invalid content in an input\n"
           "  5   a limit was hit (memory, counts, device limits)\n"
           "  6   no usable GPU\n"
           "  70  internal error\n";
}

} // namespace rt
