#include <CLI/CLI.hpp>

#include "settings_file.h"

#include <fmt/format.h>

namespace chromeball {
namespace {

std::string joined(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ",") + part;
    return all;
}

}  // namespace

bool SettingsFile::is_command(const std::string& name) const {
    const auto commands =
        app_.get_subcommands([&](const CLI::App* c) { return c->check_name(name); });
    return !commands.empty();
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
                throw CLI::ConfigError(
                    fmt::format("settings file: [{}] is no command", item.parents.front()));
            continue;
        }
        // 1,2,3 and [1, 2, 3] are both one value of ours.
        if (item.inputs.size() > 1) item.inputs = {joined(item.inputs)};
        kept.push_back(std::move(item));
    }
    return kept;
}

}  // namespace chromeball
