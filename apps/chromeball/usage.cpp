#include <CLI/CLI.hpp>

#include "usage.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/names.h"

namespace chromeball {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands(nullptr))
        names.push_back(command->get_name());
    return names;
}

std::vector<std::string> long_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back(name);
    return names;
}

bool is_number(const std::string& word) {
    return !word.empty() && word.find_first_not_of("+-.,0123456789e") == std::string::npos &&
           word.find_first_of("0123456789") != std::string::npos;
}

bool is_option(const std::string& word) { return word.starts_with('-') && !is_number(word); }

/// The words name no command.
std::string no_command(const CLI::App& app, const std::vector<std::string>& rest) {
    const auto names = command_names(app);
    const auto word = std::find_if_not(rest.begin(), rest.end(), is_option);
    if (word != rest.end()) {
        const auto near = nearest_names(*word, names, 1);
        return fmt::format("\"{}\" is no command; {} {}", *word,
                           near.empty() ? "choose" : "did you mean",
                           near.empty() ? quoted_list(names) : quoted_list(near) + "?");
    }
    if (rest.empty()) return "a command is missing; choose " + quoted_list(names);
    return fmt::format("{}: {}", rest.front(), unknown_option(app, rest.front()));
}

/// Words that the command did not take.
std::string left_over(const CLI::App& command, const std::vector<std::string>& rest) {
    if (const auto option = std::find_if(rest.begin(), rest.end(), is_option);
        option != rest.end()) {
        const std::string name = option->substr(0, option->find('='));
        if (command.get_option_no_throw(name))  // only --config may stand before
            return fmt::format("{}: options go after the command's name: chromeball {} {} ...",
                               name, command.get_name(), name);
        return fmt::format("{}: {}", name, unknown_option(command, name));
    }
    if (std::all_of(rest.begin(), rest.end(), is_number))
        return fmt::format(
            "\"{}\" is one word too many; several numbers of one option are separated by commas, "
            "without spaces: --ball 812,540,202",
            rest.front());
    return fmt::format("\"{}\" is one word too many for {}", rest.front(), command.get_name());
}

}  // namespace

std::string unknown_option(const CLI::App& command, const std::string& name) {
    const std::string of = command.get_parent() ? command.get_name() : "chromeball itself";
    auto near = nearest_names(name.substr(std::min(name.find_first_not_of('-'), name.size())),
                              long_names(command), 2);
    for (std::string& one : near) one = "--" + one;
    return fmt::format("no such option of {}{}", of,
                       near.empty() ? "" : "; did you mean " + quoted_list(near) + "?");
}

std::optional<std::string> option_without_value(int argc, const char* const* argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--") break;
        if (word.starts_with("--") && word.ends_with('=')) return word;
    }
    return std::nullopt;
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
    const auto running = app.get_subcommands();
    const auto rest = app.remaining(true);
    std::string message = error.what();
    std::string help = "chromeball --help";
    if (running.empty()) {
        message = no_command(app, rest);
    } else {
        const CLI::App& command = *running.front();
        help = fmt::format("chromeball {} --help", command.get_name());
        const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
        const bool misspelt = std::any_of(rest.begin(), rest.end(), is_option);
        // As in `convert photo.jpg probe.exr`.
        if (missing && rest.size() == 1 && !misspelt && rest.front().find('.') != std::string::npos)
            message += fmt::format("; did you mean -o {}?", rest.front());
        else if (!rest.empty() && (missing || dynamic_cast<const CLI::ExtrasError*>(&error)))
            message = left_over(command, rest);
    }
    return fmt::format("{}\n{} tells what there is", message, help);
}

}  // namespace chromeball
