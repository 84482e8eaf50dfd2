#include "io/messages.h"

#include <system_error>

namespace chromeball::io {

Error failure(const std::string& path, std::string_view text) {
    std::string line = path + ": ";
    for (const char c : text) {
        const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
        if (!blank)
            line += c;
        else if (line.back() != ' ')
            line += ' ';
    }
    while (line.back() == ' ') line.pop_back();
    return {Error::Kind::failed, line};
}

std::string system_reason(int error_number) {
    return std::generic_category().message(error_number);
}

}  // namespace chromeball::io
