//! The program itself, in a window of an X server of its own: it opens, takes what is dropped on it, closes, and takes up where
//! it ended. Where there is no display it says so.
#![cfg(target_os = "linux")]

use std::error::Error;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, ImageFormat, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Longer than anything here takes, with software that draws: a wait that ends is a failure.
const NEVER: Duration = Duration::from_secs(300);

/// A process that ends with the test.
struct Guard(Child);

impl Drop for Guard {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// An X server without a screen, and its display; `None` where there may be none.
fn display() -> Option<(Guard, String)> {
    let mut command = Command::new("Xvfb");
    command.args(["-displayfd", "1", "-screen", "0", "1280x900x24", "-nolisten", "tcp"]);
    let started = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
    let Ok(mut server) = started else {
        let allowed = std::env::var_os("PAIRWAVE_ALLOW_NO_DISPLAY").is_some_and(|v| v == "1");
        assert!(
            allowed,
            "this test needs Xvfb (Debian: apt-get install xvfb), or PAIRWAVE_ALLOW_NO_DISPLAY=1 to skip it"
        );
        eprintln!("skipped: there is no Xvfb");
        return None;
    };
    let mut number = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
    assert!(!number.trim().is_empty(), "Xvfb did not start");
    Some((Guard(server), format!(":{}", number.trim())))
}

/// The viewer with a home of its own.
fn viewer(home: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave-viewer"));
    for desktop in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DBUS_SESSION_BUS_ADDRESS", "XDG_DATA_HOME"] {
        command.env_remove(desktop);
    }
    command.env("HOME", home).env("XDG_RUNTIME_DIR", home).current_dir(home);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// What a person at the display sees and does.
struct Desk {
    x: RustConnection,
    root: Window,
    /// A window of ours, which files are dragged from.
    source: Window,
}

impl Desk {
    fn new(display: &str) -> Result<Self> {
        let (x, screen) = x11rb::connect(Some(display))?;
        let root = x.setup().roots[screen].root;
        let source = x.generate_id()?;
        let (aux, class) = (CreateWindowAux::new(), WindowClass::INPUT_OUTPUT);
        x.create_window(0, source, root, 0, 0, 1, 1, 0, class, 0, &aux)?.check()?;
        Ok(Self { x, root, source })
    }

    fn atom(&self, name: &str) -> Result<Atom> {
        Ok(self.x.intern_atom(false, name.as_bytes())?.reply()?.atom)
    }

    /// The window whose title this is true of, once there is one. The program must not have ended.
    fn wait_for(&self, program: &mut Guard, what: &str, title: impl Fn(&str) -> bool) -> Result<Window> {
        let (start, property) = (Instant::now(), self.atom("_NET_WM_NAME")?);
        let mut seen = Vec::new();
        while start.elapsed() < NEVER {
            seen.clear();
            for window in self.x.query_tree(self.root)?.reply()?.children {
                // Windows come and go.
                let name = self.x.get_property(false, window, property, AtomEnum::ANY, 0, 1024)?.reply();
                let mapped = self.x.get_window_attributes(window)?.reply().is_ok_and(|a| u8::from(a.map_state) == 2);
                let name = name.map(|n| String::from_utf8_lossy(&n.value).into_owned()).unwrap_or_default();
                if mapped && title(&name) {
                    return Ok(window);
                }
                seen.push(name);
            }
            if let Some(status) = program.0.try_wait()? {
                return Err(format!("waiting for {what}: it ended with {status}").into());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        Err(format!("waiting for {what}: there are only windows called {seen:?}").into())
    }

    /// How many colours a window shows.
    fn colors(&self, window: Window) -> Result<usize> {
        let size = self.x.get_geometry(window)?.reply()?;
        let image = self.x.get_image(ImageFormat::Z_PIXMAP, window, 0, 0, size.width, size.height, !0)?.reply()?;
        let pixels = image.data.chunks_exact(4).map(|p| [p[0], p[1], p[2]]);
        Ok(pixels.collect::<std::collections::HashSet<_>>().len())
    }

    fn tell(&self, window: Window, kind: &str, data: [u32; 5]) -> Result<()> {
        let event = ClientMessageEvent::new(32, window, self.atom(kind)?, data);
        self.x.send_event(false, window, EventMask::NO_EVENT, event)?.check()?;
        Ok(())
    }

    /// Drags a file onto a window (XDND, version 5).
    fn drop(&self, window: Window, file: &Path) -> Result<()> {
        let [list, selection, copy] = ["text/uri-list", "XdndSelection", "XdndActionCopy"].map(|name| self.atom(name));
        let (list, selection, copy) = (list?, selection?, copy?);
        let [status, finished] = ["XdndStatus", "XdndFinished"].map(|name| self.atom(name));
        let (status, finished) = (status?, finished?);
        self.x.set_selection_owner(self.source, selection, x11rb::CURRENT_TIME)?.check()?;
        self.tell(window, "XdndEnter", [self.source, 5 << 24, list, 0, 0])?;
        self.tell(window, "XdndPosition", [self.source, 0, 300 << 16 | 300, 0, copy])?;
        let start = Instant::now();
        let mut dropped = false;
        while start.elapsed() < NEVER {
            match self.x.poll_for_event()? {
                Some(Event::SelectionRequest(asked)) => {
                    let text = format!("file://{}\r\n", file.display());
                    self.x.change_property8(
                        PropMode::REPLACE,
                        asked.requestor,
                        asked.property,
                        asked.target,
                        text.as_bytes(),
                    )?;
                    let answer = SelectionNotifyEvent {
                        response_type: SELECTION_NOTIFY_EVENT,
                        sequence: 0,
                        time: asked.time,
                        requestor: asked.requestor,
                        selection: asked.selection,
                        target: asked.target,
                        property: asked.property,
                    };
                    self.x.send_event(false, asked.requestor, EventMask::NO_EVENT, answer)?.check()?;
                }
                Some(Event::ClientMessage(said)) if said.type_ == status && !dropped => {
                    dropped = true;
                    self.tell(window, "XdndDrop", [self.source, 0, 0, 0, 0])?;
                }
                Some(Event::ClientMessage(said)) if said.type_ == finished => return Ok(()),
                Some(_) => {}
                None => std::thread::sleep(Duration::from_millis(10)),
            }
        }
        Err("the window never took the file".into())
    }

    /// Closes a window as its frame would.
    fn close(&self, window: Window) -> Result<()> {
        let delete = self.atom("WM_DELETE_WINDOW")?;
        self.tell(window, "WM_PROTOCOLS", [delete, 0, 0, 0, 0])
    }
}

/// What it said, once it ended.
fn ended(mut program: Guard) -> Result<Output> {
    let start = Instant::now();
    while program.0.try_wait()?.is_none() {
        if start.elapsed() > NEVER {
            return Err("it never ended".into());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let mut output = Output { status: program.0.wait()?, stdout: Vec::new(), stderr: Vec::new() };
    for (pipe, text) in [
        (program.0.stdout.take().map(|p| Box::new(p) as Box<dyn std::io::Read>), &mut output.stdout),
        (program.0.stderr.take().map(|p| Box::new(p) as Box<dyn std::io::Read>), &mut output.stderr),
    ] {
        pipe.map(|mut pipe| pipe.read_to_end(text)).transpose()?;
    }
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{said}");
    Ok(output)
}

#[test]
fn a_window_opens_takes_files_closes_and_takes_up_where_it_ended() -> Result<()> {
    let Some((_server, display)) = display() else { return Ok(()) };
    let home = tempfile::tempdir()?;
    let (good, bad) = (home.path().join("dropped.csv"), home.path().join("bad.csv"));
    let points: String =
        (0..50).map(|k| format!("{},{}\n", f64::from(k) / 50.0, f64::from(k * 7 % 50) / 50.0)).collect();
    std::fs::write(&good, format!("x,y\n{points}"))?;
    std::fs::write(&bad, "x,y\n0.5,half\n")?;
    let desk = Desk::new(&display)?;

    let settings = ["--sampler", "jittered", "-n", "64", "-k", "4", "--device", "cpu", "--threads", "2"];
    let mut program = Guard(viewer(home.path()).env("DISPLAY", &display).args(settings).spawn()?);
    let window = desk.wait_for(&mut program, "the first set", |title| title == "jittered - pairwave")?;
    // More than a bare ground: text, curves, pictures.
    let start = Instant::now();
    while desk.colors(window)? < 100 {
        assert!(start.elapsed() < NEVER, "the window stays bare");
        std::thread::sleep(Duration::from_millis(100));
    }
    desk.drop(window, &good)?;
    desk.wait_for(&mut program, "a dropped file", |title| title == "jittered, dropped.csv - pairwave")?;
    desk.drop(window, &bad)?;
    desk.wait_for(&mut program, "a bad file", |title| title == "jittered, dropped.csv, bad.csv - pairwave")?;
    std::thread::sleep(Duration::from_millis(500));
    desk.close(window)?;
    assert_eq!(ended(program)?.status.code(), Some(0));

    let mut again = Guard(viewer(home.path()).env("DISPLAY", &display).spawn()?);
    let window =
        desk.wait_for(&mut again, "the last session", |title| title == "jittered, dropped.csv, bad.csv - pairwave")?;
    desk.close(window)?;
    assert_eq!(ended(again)?.status.code(), Some(0));

    let mut fresh = Guard(viewer(home.path()).env("DISPLAY", &display).arg("--fresh").spawn()?);
    let window = desk.wait_for(&mut fresh, "a fresh window", |title| title == "jittered - pairwave")?;
    desk.close(window)?;
    assert_eq!(ended(fresh)?.status.code(), Some(0));
    Ok(())
}

#[test]
fn without_a_display_it_says_so() -> Result<()> {
    let home = tempfile::tempdir()?;
    let output = ended(Guard(viewer(home.path()).spawn()?))?;
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("no window could be opened") && said.contains("pairwave analyze"), "{said}");
    Ok(())
}

#[test]
fn settings_that_cannot_be_are_refused_before_a_window_opens() -> Result<()> {
    let home = tempfile::tempdir()?;
    for (arguments, says) in [
        (&["--bins", "many"][..], "invalid value 'many' for '--bins <B>'"),
        (&["--session", "nowhere.json"], "nowhere.json"),
        (&["--sampler", "random"], "--sampler random needs -n N"),
    ] {
        let output = ended(Guard(viewer(home.path()).args(arguments).spawn()?))?;
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(says), "{arguments:?}: {said}");
    }
    Ok(())
}
