// Reads a trial with LCM's own Java classes and the jar of our types, as lcm-spy does, and compares what
// each message says with the tables that headpin writes of the same trial.
//
// usage: java -cp headpin-types.jar:lcm.jar ReadTrial.java HEADPIN TRIAL FOLDER-OF-TYPES EMPTY-FOLDER

import java.io.ByteArrayInputStream;
import java.io.ByteArrayOutputStream;
import java.io.DataInput;
import java.io.DataInputStream;
import java.io.DataOutputStream;
import java.io.EOFException;
import java.io.File;
import java.nio.ByteBuffer;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.stream.Collectors;

import headpin.body_state_t;
import headpin.event_t;
import headpin.mouse3d_t;
import headpin.state_change_t;
import headpin.state_t;
import headpin.tracked_device_t;
import headpin.trial_t;
import lcm.lcm.LCMEncodable;
import lcm.logging.Log;
import lcm.spy.LCMTypeDatabase;

public class ReadTrial {
  static void expect(String where, Object expected, Object found) {
    if (!expected.equals(found)) {
      throw new AssertionError(where + ": expected " + expected + ", found " + found);
    }
  }

  /** A table of `headpin export`; its rows are asked for in their order. */
  static class Table {
    final String name;
    final List<String> columns;
    final List<String[]> rows = new ArrayList<>();
    int next = 0;

    Table(Path folder, String name) throws Exception {
      this.name = name;
      List<String> lines = Files.readAllLines(folder.resolve(name + ".csv"));
      columns = Arrays.asList(lines.get(0).split(","));
      for (String line : lines.subList(1, lines.size())) {
        String[] cells = line.split(",(?=([^\"]*\"[^\"]*\")*[^\"]*$)", -1);  // commas outside quotes
        for (int i = 0; i < cells.length; ++i) {
          if (cells[i].startsWith("\"")) {
            cells[i] = cells[i].substring(1, cells[i].length() - 1).replace("\"\"", "\"");
          }
        }
        rows.add(cells);
      }
    }

    String cell(String column) {
      expect(name + ".csv: a column " + column, true, columns.contains(column));
      expect(name + ".csv: row " + (next + 1), true, next < rows.size());
      return rows.get(next)[columns.indexOf(column)];
    }

    void text(String column, String found) {
      expect(name + ".csv, row " + (next + 1) + ", " + column, cell(column), found);
    }

    void whole(String column, long found) {
      text(column, Long.toString(found));
    }

    void flag(String column, boolean found) {
      text(column, found ? "1" : "0");
    }

    /** Times are printed in seconds to the microsecond. */
    void time(String column, long utime) {
      expect(name + ".csv, row " + (next + 1) + ", " + column,
             Math.round(Double.parseDouble(cell(column)) * 1e6), utime);
    }

    /** Numbers read back to the same bits; -0 is 0. */
    void numbers(String[] of, double... found) {
      expect(name + ": numbers", of.length, found.length);
      for (int i = 0; i < of.length; ++i) {
        expect(name + ".csv, row " + (next + 1) + ", " + of[i],
               Double.parseDouble(cell(of[i])) + 0.0, found[i] + 0.0);
      }
    }
  }

  static final String[] PLACE = {"x_m", "y_m", "z_m"};
  static final String[] TURN = {"qw", "qx", "qy", "qz"};

  static void compare(Table t, tracked_device_t m) {
    t.time("device_time_s", m.device_utime);
    t.time("host_time_s", m.host_utime);
    t.time("session_time_s", m.session_utime);
    t.whole("sequence", m.sequence);
    t.whole("station", m.station);
    t.text("frame", m.frame);
    t.numbers(PLACE, m.position);
    t.numbers(TURN, m.quaternion);
    t.text("status", m.status == ' ' ? "" : String.valueOf((char) m.status));
    t.flag("stylus", (m.buttons & 1) != 0);
    t.time("sent_time_s", m.sent_utime);
    t.flag("position_estimated", m.position_estimated);
    t.flag("orientation_estimated", m.orientation_estimated);
    ++t.next;
  }

  static void compare(Table t, mouse3d_t m) {
    t.time("device_time_s", m.device_utime);
    t.time("session_time_s", m.session_utime);
    t.flag("left_thumb", m.left_thumb);
    t.flag("right_thumb", m.right_thumb);
    t.flag("trigger", m.trigger);
    ++t.next;
  }

  static void compare(Table t, event_t m) {
    if (m.kind.equals("end")) {  // of the log, not of the session: no row
      return;
    }
    t.time("time_s", m.utime);
    t.whole("tick", m.tick);
    t.text("kind", m.kind);
    t.text("bodies", String.join(";", m.bodies));
    t.numbers(PLACE, m.point);
    t.numbers(new String[] {"impulse_x_ns", "impulse_y_ns", "impulse_z_ns"}, m.impulse);
    t.numbers(new String[] {"value"}, m.value);
    t.text("detail", m.detail);
    ++t.next;
  }

  static void compareTick(Table t, long tick, long utime, long hash, int contacts) {
    t.whole("tick", tick);
    t.time("time_s", utime);
    t.text("hash", String.format("%016x", hash));
    t.whole("contacts", contacts);
  }

  static void compare(Table t, state_t m, trial_t trial) {
    expect("STATE of tick " + m.tick + ": bodies", trial.num_bodies, m.bodies.length);
    for (int i = 0; i < m.bodies.length; ++i, ++t.next) {
      body_state_t body = m.bodies[i];
      compareTick(t, m.tick, m.utime, m.hash, m.num_contacts);
      t.text("body", trial.body_names[i]);
      t.numbers(PLACE, body.position);
      t.numbers(TURN, body.quaternion);
      t.numbers(new String[] {"vx_mps", "vy_mps", "vz_mps"}, body.velocity);
      t.numbers(new String[] {"wx_radps", "wy_radps", "wz_radps"}, body.angular_velocity);
      t.flag("asleep", body.asleep);
    }
  }

  /** What is new is packed (docs/channels.md); the rest stands for itself. */
  static void compare(Table t, state_change_t m, trial_t trial) {
    expect("STATE_CHANGE of tick " + m.tick + ": bytes", m.num_bytes, m.changes.length);
    compareTick(t, m.tick, m.utime, m.hash, m.num_contacts);
    t.next += trial.num_bodies;
  }

  /** The message in an event, by the class that lcm-spy finds; its bytes are read and written whole. */
  static Object decode(LCMTypeDatabase types, Log.Event event) throws Exception {
    long fingerprint = ByteBuffer.wrap(event.data).getLong();
    String where = event.channel + ", event " + event.eventNumber;
    Class<?> type = types.getClassByFingerprint(fingerprint);
    expect(where + ": a class of fingerprint " + Long.toHexString(fingerprint), true, type != null);
    ByteArrayInputStream bytes = new ByteArrayInputStream(event.data);
    Object message = type.getConstructor(DataInput.class).newInstance(new DataInputStream(bytes));
    expect(where + ": bytes left", 0, bytes.available());
    ByteArrayOutputStream again = new ByteArrayOutputStream();
    ((LCMEncodable) message).encode(new DataOutputStream(again));
    expect(where + ": the same bytes when it is encoded again", true,
           Arrays.equals(event.data, again.toByteArray()));
    return message;
  }

  /** Every type of ours is found by its fingerprint. */
  static void expectAll(LCMTypeDatabase types, File folder) throws Exception {
    File[] files = folder.listFiles((in, name) -> name.endsWith(".lcm"));
    expect(folder + ": has types", true, files != null && files.length > 0);
    for (File file : files) {
      Class<?> type = Class.forName("headpin." + file.getName().replace(".lcm", ""));
      long fingerprint = type.getField("LCM_FINGERPRINT").getLong(null);
      expect(file.getName() + ": its class", type, types.getClassByFingerprint(fingerprint));
    }
  }

  static void run(String... command) throws Exception {
    int code = new ProcessBuilder(command).redirectOutput(ProcessBuilder.Redirect.DISCARD)
                   .redirectError(ProcessBuilder.Redirect.INHERIT).start().waitFor();
    expect(String.join(" ", command) + ": exit code", 0, code);
  }

  static Map<String, Integer> compareAll(LCMTypeDatabase types, Path log, Path tables) throws Exception {
    Table trackers = new Table(tables, "trackers"), buttons = new Table(tables, "buttons");
    Table events = new Table(tables, "events"), states = new Table(tables, "states");
    Map<String, Integer> counts = new HashMap<>();
    trial_t trial = null;
    Log in = new Log(log.toString(), "r");
    try {
      while (true) {
        Log.Event event = in.readNext();
        Object m = decode(types, event);
        counts.merge(m.getClass().getSimpleName(), 1, Integer::sum);
        if (m instanceof trial_t) {
          trial = (trial_t) m;
          expect("HEADPIN_TRIAL: scenario", Files.readString(tables.resolve("scenario.toml")), trial.scenario);
        } else if (m instanceof tracked_device_t) {
          compare(trackers, (tracked_device_t) m);
        } else if (m instanceof mouse3d_t) {
          compare(buttons, (mouse3d_t) m);
        } else if (m instanceof event_t) {
          compare(events, (event_t) m);
        } else if (m instanceof state_t) {
          compare(states, (state_t) m, trial);
        } else if (m instanceof state_change_t) {
          compare(states, (state_change_t) m, trial);
        } else {
          throw new AssertionError(event.channel + ": expected a message of a replay, found " + m.getClass());
        }
      }
    } catch (EOFException end) {
      in.close();
    }
    for (Table table : List.of(trackers, buttons, events, states)) {
      expect(table.name + ".csv: rows that have a message", table.rows.size(), table.next);
      expect(table.name + ".csv: has rows", true, table.next > 0);
    }
    return counts;
  }

  public static void main(String[] args) throws Exception {
    String headpin = args[0], trial = args[1];
    File kinds = new File(args[2]);
    Path folder = Path.of(args[3]), log = folder.resolve("replayed.lcmlog"), tables = folder.resolve("tables");
    Files.createDirectories(folder);
    run(headpin, "replay", trial, "-o", log.toString(), "--force");
    run(headpin, "export", log.toString(), "-o", tables.toString(), "--force");
    LCMTypeDatabase types = new LCMTypeDatabase();
    expectAll(types, kinds);
    Map<String, Integer> counts = compareAll(types, log, tables);
    System.out.println("as headpin exports them: " + counts.entrySet().stream()
        .map(count -> count.getValue() + " " + count.getKey()).sorted().collect(Collectors.joining(", ")));
  }
}
