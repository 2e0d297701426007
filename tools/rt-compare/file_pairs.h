#pragma once
#include <string>
#include <vector>

namespace rt {

/// Two files to compare; an empty name: the other one has no partner.
struct FilePair {
    std::string a, b;
};

/// What the two arguments name: two files; or two folders, whose pictures (by extension, in all their
/// folders) are paired by relative name; or two sequences like `frame.%04d.exr`, paired by number. Sorted by
/// name or number. Throws Error{FileAccess} if a folder cannot be read, Error{InvalidContent} if neither
/// holds a picture.
std::vector<FilePair> findPairs(const std::string& a, const std::string& b);

/// Pairs of a text file ("-": standard input): two names on each line, separated by a tab, or by spaces if
/// there is none; empty lines and those that start with # are skipped. Names are as on the command line.
/// Throws Error{FileAccess}, Error{InvalidContent} naming the line.
std::vector<FilePair> readPairList(const std::string& path);

} // namespace rt
