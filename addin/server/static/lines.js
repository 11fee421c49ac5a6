// Answers that come line by line: stages, and at the end a value or everything wrong.

/** The last line of an answer; tells its stages. `lost` is added to the error where the connection breaks. */
export async function lastLine(response, stage, lost = "") {
  const reader = response.body.getReader(), decoder = new TextDecoder();
  let text = "", last = null;
  for (;;) {
    const { done, value } = await reader.read();
    text += done ? "" : decoder.decode(value, { stream: true });
    const lines = text.split("\n");
    text = lines.pop();
    for (const line of lines) {
      last = JSON.parse(line);
      if (last.stage) stage(last.stage);
    }
    if (done) break;
  }
  if (last && last.value) return last;
  const message = ((last || {}).error || {}).message || `The connection to the calculation server was lost. ${lost ? `${lost}; try` : "Try"} again.`;
  throw { message, content: last || {} };
}
