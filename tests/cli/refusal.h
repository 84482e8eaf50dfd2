#pragma once

#include <gtest/gtest.h>

#include "cli/program.h"

namespace chromeball::test {

/// What every failed run owes its user: the status, exactly one error, the words in it, nothing on
/// stdout, and every file as it was before.
inline void expect_refusal(const TempFolder& folder, const Words& words, int status,
                           const std::vector<std::string>& says, const Circumstances& how = {}) {
    SCOPED_TRACE("chromeball " + text_of(words));
    std::vector<std::pair<std::string, std::string>> files;
    const auto content = folder.content();
    for (const std::string& name : content)
        if (!name.ends_with('/')) files.emplace_back(name, read_bytes(folder / name));

    const Outcome outcome = run(folder, words, how);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_EQ(outcome.lines_with("error: "), 1U) << outcome.err;
    EXPECT_EQ(outcome.lines_with("error"), 1U) << outcome.err;
    for (const std::string& text : says)
        EXPECT_TRUE(outcome.says(text)) << "missing: " << text << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "");

    EXPECT_EQ(folder.content(), content);
    for (const auto& [name, bytes] : files) EXPECT_TRUE(read_bytes(folder / name) == bytes) << name;
}

/// Words typed wrong, and what the answer must say.
struct Refusal {
    Words words;
    std::vector<std::string> says;
    int status = 2;
};

/// The same of many, several at a time.
inline void expect_refusals(const TempFolder& folder, const std::vector<Refusal>& cases) {
    const auto content = folder.content();
    std::vector<Words> commands;
    for (const Refusal& one : cases) commands.push_back(one.words);
    const auto outcomes = run_all(folder, commands);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE("chromeball " + text_of(cases[i].words));
        EXPECT_EQ(outcomes[i].status, cases[i].status) << outcomes[i].err;
        EXPECT_EQ(outcomes[i].lines_with("error"), 1U) << outcomes[i].err;
        for (const std::string& text : cases[i].says)
            EXPECT_TRUE(outcomes[i].says(text)) << "missing: " << text << "\n" << outcomes[i].err;
        EXPECT_EQ(outcomes[i].out, "");
    }
    EXPECT_EQ(folder.content(), content);
}

}  // namespace chromeball::test
