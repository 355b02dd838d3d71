// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/shell_text.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace lamina {
namespace {

using Words = std::vector<std::string>;

// A second witness: the words that the shell of this machine takes.
Words words_of_shell(const std::string& line) {
  FILE* shell = popen(("printf '%s\\n' " + line).c_str(), "r");
  Words words;
  std::string word;
  for (int c; (c = std::fgetc(shell)) != EOF;)
    if (c == '\n')
      words.push_back(std::exchange(word, {}));
    else
      word += static_cast<char>(c);
  pclose(shell);
  return words;
}

TEST(ShellText, WordsAreThoseOfTheShell) {
  for (const std::string line : {"render scene.json", "  a   b\t c ", "'a b' \"c d\"", "a'b c'd",
                                 "a\"b'c\"", "'' \"\"", "a\\ b \\'c\\'", "\"a\\\"b\\\\c\\d\"",
                                 "'a\\b'", "--set=\"camera.position=[1, 2]\"", "'it'\\''s'"})
    EXPECT_EQ(shell_words(line), words_of_shell(line)) << line;
}

TEST(ShellText, QuotedWordsAreReadBack) {
  for (const std::string word :
       {"plain", "", "it's", "a b", "$HOME", "\"", "\\", "*;&|", "--x=1"}) {
    EXPECT_EQ(shell_words(shell_quoted(word)), Words{word});
    EXPECT_EQ(words_of_shell(shell_quoted(word)), Words{word});
  }
}

TEST(ShellText, OpenQuotesAreRefused) {
  for (const char* line : {"'a", "a \"b", "a 'b' '"})
    EXPECT_THROW((void)shell_words(line), InvalidInput) << line;
}

TEST(ShellText, NothingHasNoWords) {
  EXPECT_EQ(shell_words(""), Words());
  EXPECT_EQ(shell_words(" \n "), Words());
}

}  // namespace
}  // namespace lamina
