#pragma once

namespace rt {

/// While one lives, the first SIGINT, SIGTERM or SIGHUP is only noted, so that work in steps can end with its
/// step; the second one ends the program as usual. One at a time.
class StopRequest {
public:
    StopRequest();
    ~StopRequest();
    StopRequest(const StopRequest&) = delete;
    StopRequest& operator=(const StopRequest&) = delete;

    /// Whether a signal came.
    bool made() const;
    /// Ends the program by the signal that came.
    [[noreturn]] void obey() const;
};

} // namespace rt
