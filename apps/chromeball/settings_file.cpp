#include <CLI/CLI.hpp>

#include "settings_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/names.h"
#include "usage.h"

namespace chromeball {
namespace {

std::string joined(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ",") + part;
    return all;
}

bool is_key(const std::string& name) {
    return std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '_';
    });
}

}  // namespace

bool SettingsFile::is_command(const std::string& name) const {
    const auto commands =
        app_.get_subcommands([&](const CLI::App* c) { return c->check_name(name); });
    return !commands.empty();
}

std::string SettingsFile::name() const {
    return fmt::format("settings file {}", joined(app_.get_config_ptr()->results()));
}

void SettingsFile::check_key(const CLI::ConfigItem& item) const {
    const CLI::App& command = *app_.get_subcommands().front();
    if (item.parents.size() == 1 && command.get_option_no_throw("--" + item.name)) return;
    if (item.inputs.empty() || item.inputs.front().empty() || !is_key(item.name))
        throw Error(Error::Kind::usage,
                    fmt::format("{}: cannot make sense of \"{}\"; a line is KEY = VALUE, as "
                                "size = 1024, the whole value on it",
                                name(), excerpt(item.name)));
    throw Error(Error::Kind::usage,
                fmt::format("{}: {}: {}", name(), item.name, unknown_option(command, item.name)));
}

std::vector<CLI::ConfigItem> SettingsFile::from_config(std::istream& input) const {
    const auto running = app_.get_subcommands();
    const std::string command = running.empty() ? "" : running.front()->get_name();
    std::vector<CLI::ConfigItem> kept;
    for (CLI::ConfigItem& item : CLI::ConfigBase::from_config(input)) {
        if (item.name == "++" || item.name == "--") continue;  // begin and end of a section
        if (item.parents.empty()) item.parents = {command};
        if (item.parents.front() != command) {
            if (!is_command(item.parents.front()))
                throw Error(Error::Kind::usage, fmt::format("{}: [{}] is no command", name(),
                                                            excerpt(item.parents.front())));
            continue;
        }
        check_key(item);
        // 1,2,3 and [1, 2, 3] are both one value of ours.
        if (item.inputs.size() > 1) item.inputs = {joined(item.inputs)};
        kept.push_back(std::move(item));
    }
    return kept;
}

}  // namespace chromeball
