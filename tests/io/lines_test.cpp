#include "io/lines.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>
#include <vector>

#include "io/files.h"

namespace chromeball {
namespace {

using test::message_of;
using test::TempFolder;

TEST(Lines, AreAddedWholeAndReadBack) {
    const TempFolder folder;
    const std::string file = folder / "a.jsonl";
    EXPECT_EQ(read_text(file), "");
    append_line(file, "one");
    append_line(file, "two\n");
    EXPECT_EQ(read_text(file), "one\ntwo\n");
}

TEST(Lines, BeginAnewBehindATornOne) {
    const TempFolder folder;
    const std::string file = folder / "a.jsonl";
    std::ofstream(file) << "one\n{\"tor";
    append_line(file, "two");
    EXPECT_EQ(read_text(file), "one\n{\"tor\ntwo\n");
}

TEST(Lines, OfManyWritersDoNotMix) {
    const TempFolder folder;
    const std::string file = folder / "a.jsonl";
    {
        std::vector<std::jthread> writers;
        for (const char letter : {'a', 'b', 'c', 'd'})
            writers.emplace_back([&file, letter] {
                for (int i = 0; i < 100; ++i) append_line(file, std::string(500, letter));
            });
    }
    const std::string text = read_text(file);
    ASSERT_EQ(text.size(), 400U * 501U);
    for (std::size_t at = 0; at < text.size(); at += 501)
        EXPECT_EQ(text.substr(at, 500), std::string(500, text[at]));
}

TEST(Lines, ThatCannotBeWrittenAreTold) {
    const TempFolder folder;
    EXPECT_NE(message_of([&] {
                  append_line(folder / "none/a.jsonl", "x");
              }).find("cannot be written: No such file"),
              std::string::npos);
}

}  // namespace
}  // namespace chromeball
