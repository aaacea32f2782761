#include "study/script.h"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/sha256.h"
#include "study/model.h"

namespace headpin::study {

namespace {

constexpr const char* kScript =
    R"R(arguments <- commandArgs(trailingOnly = TRUE)
input <- if (length(arguments) > 0) arguments[1] else "tables/participants.csv"
output <- if (length(arguments) > 1) arguments[2] else "."
who <- if (length(arguments) > 2) arguments[3] else "all"  # people, virtual or all
to <- function(name) file.path(output, name)

p <- read.csv(input, na.strings = "n/a", colClasses = c(@TEXTS@))
p <- p[p$counts == "yes", ]
if (who == "people") p <- p[p$virtual == "no", ]
if (who == "virtual") p <- p[p$virtual == "yes", ]
if (nrow(p) == 0) stop("nobody counts")
virtual <- if (all(p$virtual == "yes")) "yes" else if (all(p$virtual == "no")) "no" else "mixed"

# A column a term. Change them as you like; the rest follows.
@TERMS@
published <- data.frame(
  estimate = c(@ESTIMATES@),
  se = c(@ERRORS@))
published_deviance <- @DEVIANCE@
changes <- c(@CHANGES@)
# By the design: the terms that can be other than 0 in each change, and those that are the constant of one.
published_terms <- list(
@USED@)
published_constants <- c(@CONSTANTS@)

x <- do.call(cbind, terms)
n <- p$of[1]
y <- cbind(p$score, n - p$score)
fit_of <- function(x, ...) suppressWarnings(glm(y ~ 0 + x, family = binomial, ...))
fit <- fit_of(x)

# Estimates, as Table 6. A term that the data say nothing of is NA.
wide <- function(values) setNames(as.numeric(values), colnames(x))
errors <- function(fit) {
  se <- rep(NA, ncol(x))
  known <- !is.na(coef(fit))
  se[known] <- sqrt(diag(vcov(fit)))[names(coef(fit))[known]]
  se
}
estimate <- wide(coef(fit))
se <- errors(fit)
z <- estimate / se
bias_reduced <- bias_reduced_se <- rep(NA, ncol(x))
# Where an estimate has no end, it goes on growing with every step of the fit: separation. Terms that are
# NA are left out: with so small an epsilon, glm does not notice that they say nothing new.
at_step <- function(steps) {
  values <- estimate
  known <- !is.na(estimate)
  values[known] <- coef(fit_of(x[, known, drop = FALSE], epsilon = 1e-16, maxit = steps))
  values
}
endless <- colnames(x)[which(abs(at_step(60) - at_step(15)) > 0.5)]
separated <- if (length(endless) > 0) "yes" else "no"
if (requireNamespace("brglm2", quietly = TRUE)) {
  reduced <- fit_of(x[, !is.na(estimate), drop = FALSE], method = brglm2::brglmFit)
  bias_reduced[!is.na(estimate)] <- coef(reduced)
  bias_reduced_se[!is.na(estimate)] <- sqrt(diag(vcov(reduced)))
}
table_6 <- data.frame(
  term = colnames(x), estimate, se, z, p = 2 * pnorm(-abs(z)),
  endless = ifelse(colnames(x) %in% endless, "yes", "no"), bias_reduced, bias_reduced_se,
  published = published$estimate, published_se = published$se, virtual, row.names = NULL)

# What the deviance grows by without each term.
drop <- do.call(rbind, lapply(seq_len(ncol(x)), function(i) {
  less <- if (ncol(x) > 1) fit_of(x[, -i, drop = FALSE]) else glm(y ~ 0, family = binomial)
  grown <- deviance(less) - deviance(fit)
  df <- df.residual(less) - df.residual(fit)
  data.frame(term = colnames(x)[i], deviance = deviance(less), chi_squared = grown, df,
             p = if (df > 0) pchisq(grown, df, lower.tail = FALSE) else NA, virtual)
}))

# Linear predictors by changed parameter, as Table 5: all terms; and the constant of the change, and those of the
# other terms without which the deviance grows significantly at 5 %. n/a where nobody has the change, or nothing is published.
in_words <- function(estimates, used, constant, endless = character()) {
  used <- used & !is.na(estimates)
  number <- paste0(sprintf("%.1f", abs(estimates)), ifelse(colnames(x) %in% endless, "(endless)", ""))
  name <- sub("^.*[.]", "", colnames(x))
  first <- which(used & constant)[1]
  text <- if (is.na(first)) "0" else paste0(if (estimates[first] < 0) "-" else "", number[first])
  for (i in which(used & !constant)) {
    text <- paste0(text, if (estimates[i] < 0) " - " else " + ", number[i], "*", name[i])
  }
  text
}
predictor <- function(changed, shown) {
  mine <- p$changed == changed
  if (!any(mine)) return(NA)
  used <- apply(x[mine, , drop = FALSE] != 0, 2, any)
  constant <- apply(x[!mine, , drop = FALSE] == 0, 2, all) & apply(x[mine, , drop = FALSE] == 1, 2, all)
  in_words(estimate, used & (shown | constant), constant, endless)
}
published_predictor <- function(changed) {
  used <- colnames(x) %in% published_terms[[changed]]
  if (all(is.na(published$estimate[used]))) return(NA)
  in_words(published$estimate, used, colnames(x) %in% published_constants)
}
table_5 <- data.frame(
  changed = changes,
  predictor = sapply(changes, predictor, TRUE),
  significant = sapply(changes, predictor, drop$p < 0.05 & !is.na(drop$p)),
  published = sapply(changes, published_predictor), virtual, row.names = NULL)

# How well it fits.
pearson <- sum(residuals(fit, "pearson")^2)
# Without a degree of freedom, a fit has no error, and there is no p.
upper <- function(deviance, df) if (df > 0) pchisq(deviance, df, lower.tail = FALSE) else NA
df <- df.residual(fit)
quality <- data.frame(
  quantity = c("participants", "coefficients", "deviance", "degrees_of_freedom", "p", "null_deviance",
               "pearson_over_df", "converged", "separated", "published_deviance", "published_p",
               "r_version", "brglm2_version"),
  value = c(nrow(p), sum(!is.na(estimate)), deviance(fit), df, upper(deviance(fit), df),
            fit$null.deviance, if (df > 0) pearson / df else NA, if (fit$converged) "yes" else "no",
            separated, published_deviance, upper(published_deviance, @PUBLISHED_DF@),
            as.character(getRversion()),
            if (requireNamespace("brglm2", quietly = TRUE))
              as.character(packageVersion("brglm2")) else NA), virtual)
people <- data.frame(
  participant = p$participant, score = p$score, fitted = n * fitted(fit),
  deviance_residual = residuals(fit), leverage = hatvalues(fit),
  cooks_distance = cooks.distance(fit), virtual, row.names = NULL)

# R writes to a full disk without an error, so each file is read again.
half <- function(name) stop("cannot be written whole: ", name, " (is the disk full?)")
save <- function(data, name) {
  lines <- capture.output(write.csv(data, row.names = FALSE, na = "n/a", quote = TRUE))
  writeLines(lines, to(name))
  if (!identical(readLines(to(name), warn = FALSE), lines)) half(name)
}
save(table_5, "table-5.csv")
save(table_6, "table-6.csv")
save(drop, "drop.csv")
save(quality, "fit.csv")
save(people, "people.csv")

# Pictures, each as SVG and PNG.
ends_with <- function(name, end) {
  bytes <- readBin(to(name), "raw", file.size(to(name)))
  if (!identical(tail(bytes, length(end)), end)) half(name)
}
# R keeps the size of the last letter, and takes it for that of a new picture that lies at the same
# place in memory as the one before. A letter of another face makes R forget it.
start <- function(draw) {
  par(mar = c(0, 0, 0, 0))
  plot.new()
  strheight("M", font = 3)
  par(new = TRUE)
  draw()
}
picture <- function(name, width, height, draw) {
  svg(to(paste0(name, ".svg")), width, height)
  start(draw)
  dev.off()
  ends_with(paste0(name, ".svg"), charToRaw("</svg>\n"))
  png(to(paste0(name, ".png")), width, height, units = "in", res = 100, type = "cairo")
  start(draw)
  dev.off()
  ends_with(paste0(name, ".png"), as.raw(c(0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82)))  # IEND
}
title_of <- function(text) if (virtual == "no") text else sprintf("%s (virtual participants: %s)", text, virtual)
invisible(picture("effects", 7, 1 + 0.4 * ncol(x), function() {
  par(mar = c(4, 9, 2, 1))
  low <- bias_reduced - 1.96 * bias_reduced_se
  high <- bias_reduced + 1.96 * bias_reduced_se
  if (all(is.na(low))) { low <- estimate - 1.96 * se; high <- estimate + 1.96 * se }
  shown <- range(c(low, high, published$estimate, 0), na.rm = TRUE, finite = TRUE)
  shown <- pmax(pmin(shown, 15), -15)
  at <- rev(seq_len(ncol(x)))
  plot(NA, xlim = shown, ylim = c(0.5, ncol(x) + 0.5), yaxt = "n", ylab = "",
       xlab = "estimate and 95 % interval (log odds of a high answer)", main = title_of("Effects"))
  axis(2, at, colnames(x), las = 1)
  abline(v = 0, col = "grey")
  segments(low, at, high, at, lwd = 2, col = "#1f6fb4")
  points((low + high) / 2, at, pch = 19, col = "#1f6fb4")
  points(published$estimate, at, pch = 4, col = "#c9a227", lwd = 2)
  legend("bottomright", c("this study", "published"), pch = c(19, 4), col = c("#1f6fb4", "#c9a227"), bty = "n")
}))
invisible(picture("scores", 7, 4.5, function() {
  par(mar = c(7, 4, 2, 1))
  condition <- factor(paste(p$cell, p$changed))
  stripchart(p$score ~ condition, vertical = TRUE, method = "stack", pch = 19, col = "#1f6fb4",
             ylim = c(0, n), las = 2, ylab = sprintf("high answers of %d", n), main = title_of("Scores by condition"))
  points(seq_along(levels(condition)), tapply(n * fitted(fit), condition, mean), pch = 3, lwd = 2, col = "#c9a227")
  legend("topright", c("a participant", "mean fitted"), pch = c(19, 3), col = c("#1f6fb4", "#c9a227"), bty = "n")
}))
)R";

/// The text without line breaks and other control characters, which would end a comment.
std::string on_one_line(std::string text) {
  for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return text;
}

std::string in_quotes(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : on_one_line(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

void fill(std::string& text, const std::string& place, const std::string& value) {
  text.replace(text.find(place), place.size(), value);
}

std::string numbers(const Design& design, std::optional<double> Term::*which) {
  std::vector<std::string> all;
  for (const Term& term : design.terms) {
    all.push_back(term.*which ? fmt::format("{}", *(term.*which)) : "NA");
  }
  return fmt::format("{}", fmt::join(all, ", "));
}

/// Whether somebody whose `changed` parameter changes can have another value of a term than 0.
bool is_in(const Term& term, std::size_t changed, const Design& design) {
  for (std::size_t row = 0; row < design.rows.size(); ++row) {
    if (design.rows[row].changed != changed) continue;
    const std::optional<double> value = value_of(term, design, {row, false, false}, {});
    if (!value || *value != 0.0) return true;  // no value: an answer decides
  }
  return false;
}

/// The terms of each change, as a list of R.
std::string terms_by_change(const Design& design) {
  std::vector<std::string> all;
  for (std::size_t changed = 0; changed < design.factors.size(); ++changed) {
    std::vector<std::string> names;
    for (const Term& term : design.terms) {
      if (is_in(term, changed, design)) names.push_back(in_quotes(term.name));
    }
    all.push_back(fmt::format("  {} = c({})", in_quotes(design.factors[changed].key),
                              fmt::join(names, ", ")));
  }
  return fmt::format("{}", fmt::join(all, ",\n"));
}

/// The terms that are 1 in one change and 0 in the others.
std::string constants_of(const Design& design) {
  std::vector<std::string> names;
  for (const Term& term : design.terms) {
    int changes = 0;
    for (std::size_t changed = 0; changed < design.factors.size(); ++changed) {
      changes += is_in(term, changed, design) ? 1 : 0;
    }
    if (term.of.empty() && changes == 1) names.push_back(in_quotes(term.name));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The columns that R must not take for numbers: digits of the design, names, and answers that a term
/// compares. An answer called inf or nan is one.
std::string columns_of_text(const Design& design) {
  std::set<std::string> columns = {"cell", "participant"}, numbers;
  for (const Term& term : design.terms) {
    const bool factor = std::ranges::count(design.factors, term.of, &Factor::letter) > 0;
    if (!factor && !term.of.empty()) (term.is.empty() ? numbers : columns).insert(term.of);
  }
  for (const std::string& number : numbers) columns.erase(number);
  std::vector<std::string> texts;
  for (const std::string& column : columns) texts.push_back(column + " = \"character\"");
  return fmt::format("{}", fmt::join(texts, ", "));
}

constexpr const char* kHash = "# SHA-256 of the lines above, as headpin wrote them: ";

/// The last line of a script.
std::string hash_line(const std::string& lines_above) {
  return fmt::format("{}{}\n", kHash, base::sha256(lines_above));
}

}  // namespace

std::string r_script(const Design& design) {
  if (design.terms.empty()) {
    throw std::invalid_argument(
        fmt::format("design '{}' has no terms, so there is no model to fit", design.name));
  }
  std::string terms = "terms <- list(\n";
  for (const Term& term : design.terms) {
    terms += fmt::format("  {} = {}{}\n", in_quotes(term.name), in_r(term, design),
                         &term == &design.terms.back() ? ")" : ",");
  }
  std::vector<std::string> changes;
  for (const Factor& factor : design.factors) changes.push_back(in_quotes(factor.key));
  std::string script = fmt::format(
      "# The analysis of a study by the design {}. `headpin experiment analyse` runs what stands "
      "here, however\n# it was changed; by hand, in the study's folder: Rscript model.R "
      "tables/participants.csv analysis\n",
      on_one_line(design.name));
  std::string rest = kScript;
  fill(rest, "@TEXTS@", columns_of_text(design));
  fill(rest, "@TERMS@", terms);
  fill(rest, "@ESTIMATES@", numbers(design, &Term::estimate));
  fill(rest, "@ERRORS@", numbers(design, &Term::se));
  fill(rest, "@DEVIANCE@", design.deviance ? fmt::format("{}", *design.deviance) : "NA");
  fill(rest, "@PUBLISHED_DF@", fmt::format("{}", design.block() - std::ssize(design.terms)));
  fill(rest, "@CHANGES@", fmt::format("{}", fmt::join(changes, ", ")));
  fill(rest, "@USED@", terms_by_change(design));
  fill(rest, "@CONSTANTS@", constants_of(design));
  script += rest;
  return script + hash_line(script);
}

bool is_unedited_script(const std::string& text) {
  const std::size_t at = text.rfind(kHash);
  return at != std::string::npos && text.substr(at) == hash_line(text.substr(0, at));
}

std::vector<std::string> r_outputs() {
  return {"table-5.csv", "table-6.csv", "drop.csv",   "fit.csv",   "people.csv",
          "effects.svg", "effects.png", "scores.svg", "scores.png"};
}

}  // namespace headpin::study
