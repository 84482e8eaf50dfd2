#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>

namespace chromeball {

/// Settings in TOML: keys are option names, bare or in a section named like a command. Bare keys
/// and the section of the command that runs apply; sections of other commands are left alone.
class SettingsFile : public CLI::ConfigBase {
public:
    explicit SettingsFile(const CLI::App& app) : app_(app) {}
    std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

private:
    bool is_command(const std::string& name) const;
    std::string name() const;
    /// Throws Error (usage) where the running command has no such option.
    void check_key(const CLI::ConfigItem& item) const;

    const CLI::App& app_;
};

}  // namespace chromeball
