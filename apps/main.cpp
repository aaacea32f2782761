#include <CLI/CLI.hpp>
#include <iostream>

int main(int argc, char** argv) {
  CLI::App app{"headpin: a headless immersive bowling simulator", "headpin"};
  app.require_subcommand(1);
  CLI11_PARSE(app, argc, argv);
}
