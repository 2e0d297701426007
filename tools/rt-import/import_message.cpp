#include "tools/rt-import/import_message.h"

#include "common/error.h"

#include <nlohmann/json.hpp>

namespace rt {

std::string toText(const ImportMessage& message) {
    return message.filesAsked + '\0' + message.report;
}

ImportMessage readMessage(const std::string& text, const std::string& name) {
    ImportMessage message;
    std::size_t at = 0;
    for (std::size_t end = 0; (end = text.find('\0', at)) != std::string::npos && end > at;) at = end + 1;
    message.filesAsked = text.substr(0, at);
    if (at < text.size() && text[at] == '\0') message.report = text.substr(at + 1);
    if (!nlohmann::json::parse(message.report, nullptr, false).is_object())
        throw Error(ErrorKind::InvalidContent,
                    name + ": its loader handed over no report; the file is damaged, or made to do harm");
    return message;
}

} // namespace rt
